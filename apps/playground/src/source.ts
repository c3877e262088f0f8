// Where a simulation comes from. A source carries the protocol's messages whole and in order; the page does not know
// whether a server, a Worker or a recording is behind it.
import {decode, type Frame, type HostMessage, type Mesh} from './protocol';

export interface Listener {
  message(message: HostMessage): void;
  frame(frame: Frame): void;
  mesh(mesh: Mesh): void;
  connected(connected: boolean): void;
}
export interface Source {
  send(message: object): void;
}

/** The native engine over a WebSocket. Reconnects by itself; what is sent while the line is down is dropped. */
export class SocketSource implements Source {
  private socket?: WebSocket;
  private delay = 250;

  constructor(private url: string, private listener: Listener) { this.connect(); }

  send(message: object): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }

  private connect(): void {
    const socket = new WebSocket(this.url);
    socket.binaryType = 'arraybuffer';
    socket.onopen = () => {
      this.delay = 250;
      this.send({type: 'hello', protocol: 1});
      this.listener.connected(true);
    };
    socket.onmessage = (event) => this.receive(event.data);
    socket.onclose = () => {
      this.listener.connected(false);
      setTimeout(() => this.connect(), this.delay);
      this.delay = Math.min(2 * this.delay, 4000);
    };
    this.socket = socket;
  }

  private receive(data: string | ArrayBuffer): void {
    if (typeof data === 'string') {
      this.listener.message(JSON.parse(data) as HostMessage);
      return;
    }
    const message = decode(data);
    if (message.kind === 'mesh') this.listener.mesh(message);
    else {
      this.listener.frame(message);
      this.send({type: 'ack', sequence: message.sequence});
    }
  }
}
