// Where a simulation comes from. A source carries the protocol's messages whole and in order; the page does not know
// whether a server, a Worker or a recording is behind it.
import type {WithEngine} from './early';
import {decode, type Frame, type HostMessage, type Mesh, type Points, type Surface} from './protocol';

export interface Listener {
  message(message: HostMessage): void;
  frame(frame: Frame): void;
  mesh(mesh: Mesh): void;
  points(points: Points): void;
  surface(surface: Surface): void;
  /** A recording that the host made. */
  file(bytes: ArrayBuffer): void;
  connected(connected: boolean): void;
}
export interface Source {
  send(message: object): void;
  /** A part of a file, as docs/protocol.md says. */
  sendBytes(bytes: ArrayBuffer): void;
}

/** A message of the host, for whoever listens; frames are acknowledged once they have been taken in. */
function deliver(data: string | ArrayBuffer, listener: Listener, source: Source): void {
  if (typeof data === 'string') {
    listener.message(JSON.parse(data) as HostMessage);
    return;
  }
  const message = decode(data);
  if (message.kind === 'mesh') listener.mesh(message);
  else if (message.kind === 'points') listener.points(message);
  else if (message.kind === 'surface') listener.surface(message);
  else if (message.kind === 'file') listener.file(message.bytes);
  else {
    // Acknowledged even where drawing it fails: the host waits for it with the next one.
    try { listener.frame(message); } finally { source.send({type: 'ack', sequence: message.sequence}); }
  }
}

/** The engine as WebAssembly in a Worker of this page: the one that early.ts started. */
export class WorkerSource implements Source {
  private worker = (window as WithEngine).engine ?? new Worker(new URL('worker.js', document.baseURI), {type: 'module'});

  constructor(listener: Listener) {
    this.worker.onmessage = (event: MessageEvent<string | ArrayBuffer>) => deliver(event.data, listener, this);
    this.worker.onerror = () => listener.message({type: 'error', message: 'The engine of this page stopped. Reload the page to start it again.'});
    this.send({type: 'hello', protocol: 1});
  }
  send(message: object): void { this.worker.postMessage(JSON.stringify(message)); }
  sendBytes(bytes: ArrayBuffer): void { this.worker.postMessage(bytes, [bytes]); }
}

/** The native engine over a WebSocket. Reconnects by itself; what is sent while the line is down is dropped. */
export class SocketSource implements Source {
  private socket?: WebSocket;
  private delay = 250;

  constructor(private url: string, private listener: Listener) { this.connect(); }

  send(message: object): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }

  sendBytes(bytes: ArrayBuffer): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(bytes);
  }

  private connect(): void {
    const socket = new WebSocket(this.url);
    socket.binaryType = 'arraybuffer';
    socket.onopen = () => {
      this.delay = 250;
      this.send({type: 'hello', protocol: 1});
      this.listener.connected(true);
    };
    socket.onmessage = (event) => deliver(event.data, this.listener, this);
    socket.onclose = () => {
      this.listener.connected(false);
      setTimeout(() => this.connect(), this.delay);
      this.delay = Math.min(2 * this.delay, 4000);
    };
    this.socket = socket;
  }
}
