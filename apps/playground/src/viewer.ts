// Draws the bodies of a scene with three.js: instanced shapes, soft shadows, a ground with a metric grid.
import * as THREE from 'three';
import {OrbitControls} from 'three/addons/controls/OrbitControls.js';
import {LineMaterial} from 'three/addons/lines/LineMaterial.js';
import {LineSegments2} from 'three/addons/lines/LineSegments2.js';
import {LineSegmentsGeometry} from 'three/addons/lines/LineSegmentsGeometry.js';
import {Bodies} from './bodies';
import {stepBack, widened} from './framing';
import {Ground} from './ground';
import {surroundings} from './light';
import {Cloud, Surfaces} from './particles';
import type {Body, Camera, Frame, Mesh, Points, Surface} from './protocol';

/** m: as far away as it may be; the depth buffer then tells apart what lies close together. */
const nearPlane = (distance: number) => Math.max(0.02, distance / 150);

export class Viewer {
  readonly renderer: THREE.WebGLRenderer;
  camera: THREE.PerspectiveCamera | THREE.OrthographicCamera = new THREE.PerspectiveCamera();
  dimension: 2 | 3 = 3;
  private scene = new THREE.Scene();
  private bodies = new Bodies();
  private controls: OrbitControls;
  private sun = new THREE.DirectionalLight('#fff4e0', 2.4);
  private surroundings = new THREE.LightProbe(surroundings(), 1);
  private scheme = matchMedia('(prefers-color-scheme: dark)');
  private ground = new Ground();
  private mark = new THREE.Group();
  private cloud = new Cloud();
  private surfaces = new Surfaces();
  private lines = new LineSegments2(new LineSegmentsGeometry(), new LineMaterial({vertexColors: true, linewidth: 2.5}));
  private hand = new THREE.Line(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({color: '#ff2d55', depthTest: false}));
  private origin = new THREE.Vector3();
  private follow = -1;
  private home: Camera = {position: [8, 6, 12], target: [0, 1, 0]};
  private framed = {width: 0, height: 0};
  private stale = true;  // something to draw has changed
  private fresh = true;  // nothing opened, or its bodies stand nowhere yet
  private touched = false;  // the user has turned the view; nothing else may
  private quality = 2;
  private slowness = 16;
  private lastFrame = 0;
  private nextChange = 2000;

  constructor(private canvas: HTMLCanvasElement) {
    const context = canvas.getContext('webgl2', {antialias: true});
    if (!context) throw new Error('it needs WebGL2, which browsers have had since 2021. Here it is turned off, or the graphics driver lacks it');
    this.renderer = new THREE.WebGLRenderer({canvas, context});
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = THREE.PCFShadowMap;
    this.renderer.toneMapping = THREE.ACESFilmicToneMapping;
    this.renderer.toneMappingExposure = 0.95;
    this.sun.castShadow = true;
    this.sun.shadow.mapSize.set(2048, 2048);
    this.sun.shadow.bias = -0.0004;
    this.sun.shadow.normalBias = 0.02;
    this.sun.shadow.radius = 3;
    this.hand.renderOrder = 10;
    this.hand.visible = false;
    this.lines.visible = false;
    this.lines.frustumCulled = this.hand.frustumCulled = false;
    this.scene.add(this.bodies.root, this.sun, this.sun.target, this.surroundings, this.ground.group, this.lines, this.hand, this.mark, this.bodies.trails.group, this.cloud.object, this.surfaces.group);
    this.controls = new OrbitControls(this.camera, canvas);
    this.scheme.addEventListener('change', () => this.setTheme());
    this.setTheme();
  }

  setTheme(): void {
    this.stale = true;
    const chosen = document.documentElement.dataset.theme, dark = chosen ? chosen === 'dark' : this.scheme.matches;
    this.scene.background = new THREE.Color(dark ? '#10161f' : '#dde6ee');
    this.scene.fog = null;
    this.ground.setTheme(dark);
  }

  /** A new demo: camera, dimension, nothing drawn yet. */
  open(dimension: 2 | 3, camera: Camera): void {
    this.stale = true;
    this.lost = '';
    this.clear();
    this.bodies.open(dimension);
    this.dimension = dimension;
    // Far from the world's origin everything is drawn about the camera's target: the GPU computes in float.
    const target = new THREE.Vector3(...(camera.target as [number, number, number]));
    this.origin.copy(target.length() > 1e4 ? target : new THREE.Vector3());
    const near = (p: number[]) => p.map((x, i) => x - this.origin.getComponent(i));
    this.home = {...camera, position: near(camera.position), target: near(camera.target)};
    this.fresh = true;
    this.resetView();
  }

  resetView(): void {
    const {position, target} = this.home;
    const aspect = this.canvas.clientWidth / Math.max(1, this.canvas.clientHeight);
    this.framed = {width: this.canvas.clientWidth, height: this.canvas.clientHeight};
    this.follow = this.home.follow ?? -1;
    this.controls.dispose();
    if (this.dimension === 2) {
      const height = widened(this.home, aspect, this.bodies.seen());
      this.bodies.pixel = height / 600;
      this.camera = new THREE.OrthographicCamera(-height * aspect / 2, height * aspect / 2, height / 2, -height / 2, 0.1, 100);
      this.camera.position.set(target[0], target[1], 50);
      this.controls = new OrbitControls(this.camera, this.canvas);
      this.controls.enableRotate = false;
      this.controls.mouseButtons.LEFT = THREE.MOUSE.PAN;
      this.controls.touches.ONE = THREE.TOUCH.PAN;
      this.controls.target.set(target[0], target[1], 0);
      this.controls.addEventListener('start', () => { this.touched = true; });
      this.controls.addEventListener('change', () => { this.stale = true; });
    } else {
      const away = new THREE.Vector3(...(position as [number, number, number])).sub(new THREE.Vector3(...(target as [number, number, number])));
      const back = stepBack(this.home, aspect, this.bodies.seen());
      away.multiplyScalar(back);
      if (away.y < 0) away.y /= back;  // who looks up from the ground steps back on it, not under it
      const distance = away.length();
      this.camera = new THREE.PerspectiveCamera((this.home.field_of_view ?? 0.8) * 180 / Math.PI, aspect, nearPlane(distance), Math.max(2000, 40 * distance));
      this.camera.position.set(target[0], target[1], target[2]).add(away);
      this.controls = new OrbitControls(this.camera, this.canvas);
      this.controls.target.set(target[0], target[1], target[2]);
      this.controls.addEventListener('start', () => { this.touched = true; });
      this.controls.addEventListener('change', () => { this.stale = true; });
      this.controls.maxPolarAngle = Math.PI * 0.95;
      this.sunFor(distance);
      this.ground.setScale(distance);
    }
    this.controls.enableDamping = !matchMedia('(prefers-reduced-motion: reduce)').matches;
    this.controls.dampingFactor = 0.12;
    this.controls.update();
    this.resize();
    this.touched = false;
    if (this.dimension === 2) this.ground.showPlane(this.camera instanceof THREE.OrthographicCamera ? this.camera.top - this.camera.bottom : 20, aspect, target);
  }

  private sunFor(distance: number): void {
    const reach = Math.max(6, 0.9 * distance);
    const camera = this.sun.shadow.camera;
    camera.left = camera.bottom = -reach;
    camera.right = camera.top = reach;
    camera.near = 0.1;
    camera.far = 6 * reach;
    camera.updateProjectionMatrix();
    this.sun.userData.reach = reach;
  }

  setGround(level: number | undefined): void {
    this.stale = true;
    if (this.dimension === 3) this.ground.showGround(level === undefined ? undefined : level - this.origin.y);
  }

  enableOrbit(enabled: boolean): void { this.controls.enabled = enabled; }

  private clear(): void {
    this.bodies.clear();
    this.showMark();
    this.cloud.clear();
    this.surfaces.clear();
    this.setLines(new Float32Array(), new Uint32Array());
    this.showHand();
  }

  setBodies(bodies: Body[]): void {
    this.stale = true;
    this.clear();
    for (const body of bodies) this.addBody(body);
    if (!this.fresh) return;
    if (!this.touched) this.resetView();
    // The shaders are on their way to the driver while the first poses are on theirs.
    this.ground.update(this.camera);
    this.renderer.compile(this.scene, this.camera);
  }

  addBody(body: Body): void {
    this.stale = true;
    this.bodies.add(body, this.origin);
    if (!this.lost || body.name !== this.lost) return;
    // What changes its shapes comes again under another number.
    if (this.home.follow === this.follow) this.home = {...this.home, follow: body.id};
    this.follow = body.id;
    this.lost = '';
  }
  removeBodies(ids: number[]): void {
    this.stale = true;
    if (ids.includes(this.follow)) this.lost = this.bodies.get(this.follow)?.body.name ?? '';
    this.bodies.remove(ids);
  }
  private lost = '';  // the name of the body that was followed, when it is gone
  addMesh(mesh: Mesh): void { this.stale = true; this.bodies.addMesh(mesh); }
  setPoints(points: Points): void { this.stale = true; this.cloud.set(points, this.origin.clone().negate(), this.dimension === 2); }
  setSurface(surface: Surface): void { this.stale = true; this.surfaces.set(surface, this.origin.clone().negate(), this.dimension === 2); }

  apply(frame: Frame): void {
    this.stale = true;
    this.fresh = false;
    // Positions come relative to the frame's origin; what is drawn is relative to the view's own.
    const shift = new THREE.Vector3(frame.origin[0] - this.origin.x, frame.origin[1] - this.origin.y, frame.origin[2] - this.origin.z);
    this.bodies.apply(frame, shift);
    const followed = this.bodies.get(this.follow);
    if (followed) this.moveWith(followed.position);
    this.setLines(frame.lines, frame.lineColors);
    this.lines.position.copy(shift);
    if (this.dimension === 2) this.lines.position.z = 1;
  }

  /** Bodies in the colours of their speeds, or in their own again. */
  showHeat(on: boolean): void { this.stale = true; this.bodies.showHeat(on); }

  private moveWith(position: THREE.Vector3): void {
    const shift = position.clone().sub(this.controls.target);
    if (this.dimension === 2) shift.z = 0;
    this.camera.position.add(shift);
    this.controls.target.add(shift);
  }

  lineCount = 0;
  private setLines(points: Float32Array, colors: Uint32Array): void {
    this.lineCount = colors.length;
    this.lines.visible = colors.length > 0;
    if (!this.lines.visible) return;
    const rgb = new Float32Array(6 * colors.length), one = new THREE.Color();
    colors.forEach((c, i) => {
      one.setRGB((c >>> 24) / 255, (c >>> 16 & 255) / 255, (c >>> 8 & 255) / 255, THREE.SRGBColorSpace);
      for (const k of [0, 3]) rgb.set([one.r, one.g, one.b], 6 * i + k);
    });
    this.lines.geometry.dispose();
    this.lines.geometry = new LineSegmentsGeometry();
    this.lines.geometry.setPositions(points);
    this.lines.geometry.setColors(rgb);
  }

  /** Where the camera is and what it looks at, in world coordinates. */
  get viewpoint(): number[] { return [...this.camera.position.clone().add(this.origin).toArray(), ...this.controls.target.clone().add(this.origin).toArray()]; }
  set viewpoint([x, y, z, tx, ty, tz]: number[]) {
    this.stale = true;
    this.camera.position.set(x, y, z).sub(this.origin);
    this.controls.target.set(tx, ty, tz).sub(this.origin);
    this.controls.update();
    this.touched = true;
  }

  /** What the view shows, as a PNG. */
  picture(): Promise<Blob | null> {
    this.renderer.render(this.scene, this.camera);
    return new Promise((resolve) => this.canvas.toBlob(resolve));
  }

  /** The ray through a place of the canvas (CSS pixels), in world coordinates. */
  ray(x: number, y: number): THREE.Ray {
    const box = this.canvas.getBoundingClientRect();
    this.camera.updateMatrixWorld();  // it may have been put elsewhere since the last picture
    const caster = new THREE.Raycaster();
    caster.setFromCamera(new THREE.Vector2(2 * (x - box.left) / box.width - 1, 1 - 2 * (y - box.top) / box.height), this.camera);
    caster.ray.origin.add(this.origin);
    return caster.ray;
  }

  /** The body under a place of the canvas, sensors apart; −1: none. */
  bodyAt(x: number, y: number): number {
    const ray = this.ray(x, y);
    ray.origin.sub(this.origin);
    return this.bodies.hit(new THREE.Raycaster(ray.origin, ray.direction));
  }

  nameOf(id: number): string { return this.bodies.get(id)?.body.name || `body ${id}`; }
  get chosenBody(): number { return this.bodies.chosen; }
  choose(id: number): void {
    this.stale = true;
    this.bodies.choose(id);
  }
  /** The body that moves before or after the chosen one. */
  neighbour(way: number): number {
    const ids = this.bodyIds('dynamic'), chosen = this.bodies.chosen;
    if (ids.length === 0) return -1;
    return ids[(ids.indexOf(chosen) + way + ids.length + (chosen < 0 && way < 0 ? 1 : 0)) % ids.length];
  }
  /** The camera goes with the chosen body; asked again, or with none chosen, it stays where it is. */
  followChosen(): void {
    this.stale = true;
    this.follow = this.follow === this.bodies.chosen ? -1 : this.bodies.chosen;
    const drawn = this.bodies.get(this.follow);
    if (drawn) this.moveWith(drawn.position);
  }
  get followed(): number { return this.follow; }

  showShapes(on: boolean): void { this.stale = true; this.bodies.root.visible = on; }
  showShadows(on: boolean): void { this.stale = true; this.sun.castShadow = on; }
  showTrails(on: boolean): void { this.stale = true; this.bodies.showTrails(on); }

  /** A point with its normal, where a probe hit; without a point nothing. */
  showMark(point?: number[], normal?: number[]): void {
    this.stale = true;
    this.mark.visible = point !== undefined;
    if (!point || !normal) return;
    if (this.mark.children.length === 0) {
      const material = new THREE.MeshBasicMaterial({color: '#d6006c', depthTest: false});
      this.mark.add(new THREE.Mesh(new THREE.SphereGeometry(0.12, 16, 12), material), new THREE.Mesh(new THREE.CylinderGeometry(0.03, 0.03, 1, 8).translate(0, 0.5, 0), material));
      this.mark.renderOrder = 11;
    }
    this.mark.position.set(point[0], point[1], point[2]).sub(this.origin);
    const way = new THREE.Vector3(normal[0], normal[1], normal[2]);
    this.mark.children[1].visible = way.lengthSq() > 0.5;
    this.mark.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), way.lengthSq() > 0.5 ? way.normalize() : new THREE.Vector3(0, 1, 0));
    const size = this.camera instanceof THREE.OrthographicCamera ? (this.camera.top - this.camera.bottom) / this.camera.zoom / 12 : this.camera.position.distanceTo(this.mark.position) / 14;
    this.mark.scale.setScalar(size);
  }

  /** Whether a body that moves lies under the pointer: then a drag pulls it, otherwise it turns the view. */
  dynamicBodyAt(x: number, y: number): boolean {
    return this.bodies.get(this.bodyAt(x, y))?.body.type === 'dynamic';
  }

  /** Where a body's origin appears on the page (CSS pixels), for tests and labels. */
  screenOf(id: number): {x: number; y: number} | undefined {
    const drawn = this.bodies.get(id);
    if (!drawn) return undefined;
    const box = this.canvas.getBoundingClientRect();
    this.camera.updateMatrixWorld();
    const p = drawn.position.clone().project(this.camera);
    return {x: box.left + (p.x + 1) / 2 * box.width, y: box.top + (1 - p.y) / 2 * box.height};
  }
  bodyPosition(id: number): number[] | undefined { return this.bodies.get(id)?.position.toArray(); }
  bodyIds(type: Body['type']): number[] { return this.bodies.ids(type); }

  get viewDirection(): THREE.Vector3 { return this.camera.getWorldDirection(new THREE.Vector3()); }

  /** The spring between a grabbed point and the pointer; no arguments: hidden. World coordinates. */
  showHand(from?: THREE.Vector3, to?: THREE.Vector3): void {
    this.stale = true;
    this.hand.visible = !!(from && to);
    if (from && to) this.hand.geometry.setFromPoints([from.clone().sub(this.origin), to.clone().sub(this.origin)]);
  }

  resize(): void {
    this.stale = true;
    const width = this.canvas.clientWidth, height = Math.max(1, this.canvas.clientHeight);
    if (!this.touched && this.framed.width > 0 && Math.abs(width / height - this.framed.width / this.framed.height) > 0.02) return this.resetView();
    this.renderer.setSize(width, height, false);
    if (this.camera instanceof THREE.PerspectiveCamera) this.camera.aspect = width / height;
    else {
      const half = (this.camera.top - this.camera.bottom) / 2;
      this.camera.left = -half * width / height;
      this.camera.right = half * width / height;
    }
    this.camera.updateProjectionMatrix();
  }

  /** Where frames take too long for a second (no GPU, an old phone), draws less finely; never the other way, which would flicker. */
  private adapt(now: number): void {
    const took = now - this.lastFrame;
    this.lastFrame = now;
    if (took > 1000 || this.quality === 0) return;
    this.slowness = 0.9 * this.slowness + 0.1 * took;
    if (this.slowness < 45 || now < this.nextChange) return;
    this.nextChange = now + 1500;
    this.quality -= 1;
    if (this.quality === 1) {
      this.renderer.setPixelRatio(1);
      this.sun.shadow.mapSize.set(1024, 1024);
    } else {
      this.renderer.setPixelRatio(0.6);
      this.renderer.shadowMap.autoUpdate = false;
      this.sun.castShadow = false;
    }
    this.sun.shadow.map?.dispose();
    this.sun.shadow.map = null;
    this.resize();
  }

  render(now: number): void {
    // A picture of an empty world would only have shaders compiled before there is anything to see.
    if (this.fresh) return;
    this.adapt(now);
    // A picture that would be the one before is not drawn: that spares a phone's battery.
    if (!this.controls.update() && !this.stale) return;
    this.stale = false;
    if (this.camera instanceof THREE.PerspectiveCamera) {
      const near = nearPlane(this.camera.position.distanceTo(this.controls.target));
      if (Math.abs(near / this.camera.near - 1) > 0.1) { this.camera.near = near; this.camera.updateProjectionMatrix(); }
    }
    const reach = this.sun.userData.reach ?? 20;
    const center = this.controls.target;
    this.sun.target.position.copy(center);
    this.sun.position.copy(center).add(new THREE.Vector3(0.45, 1, 0.35).normalize().multiplyScalar(3 * reach));
    this.camera.updateMatrixWorld();
    this.ground.update(this.camera);
    this.cloud.view(this.camera, this.renderer.domElement.height / 2, this.sun.position.clone().sub(center));
    this.renderer.render(this.scene, this.camera);
  }
}
