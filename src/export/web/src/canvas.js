// Particles, polygons and soft bodies on a WebGL2 canvas.
import earcut from 'earcut';

const kParticleVertex = `#version 300 es
in float x; in float y; in float value;
uniform vec4 box; uniform vec4 view; uniform float size; uniform sampler2D palette; uniform vec3 plain;
flat out vec3 color;
void main() {
  vec2 p = (box.xy + vec2(x, y) * box.zw - view.xy) * view.zw;
  gl_Position = vec4(p, 0.0, 1.0);
  gl_PointSize = size;
  color = plain.r >= 0.0 ? plain : textureLod(palette, vec2((value * 32.0 + 0.5) / 33.0, 0.5), 0.0).rgb;
}`;
const kParticleFragment = `#version 300 es
precision mediump float;
flat in vec3 color; out vec4 pixel;
void main() {
  vec2 d = gl_PointCoord * 2.0 - 1.0;
  if (dot(d, d) > 1.0) discard;
  pixel = vec4(color, 1.0);
}`;
const kPictureVertex = `#version 300 es
void main() { gl_Position = vec4(vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0), 0.0, 1.0); }`;
const kPictureFragment = `#version 300 es
precision mediump float;
uniform sampler2D picture; out vec4 pixel;
void main() { pixel = texelFetch(picture, ivec2(gl_FragCoord.xy), 0); }`;
const kShapeVertex = `#version 300 es
in vec2 at; in vec3 tint; uniform vec4 view; flat out vec3 color;
void main() { gl_Position = vec4((at - view.xy) * view.zw, 0.0, 1.0); color = tint; }`;
const kShapeFragment = `#version 300 es
precision mediump float;
flat in vec3 color; out vec4 pixel;
void main() { pixel = vec4(color, 1.0); }`;

const kFill = [0.80, 0.81, 0.83];
const kOutline = [0.27, 0.29, 0.32];
const kOpenSide = [0.85, 0.86, 0.88];
const kBackground = [1, 1, 1];
// Discs up to this diameter [pixels] are stamped into a picture by the processor: without a graphics card a point takes ten
// times as long, and with one the picture costs nothing.
const kStampedTo = 8;
const kSpread = 1.35; // a particle's disc against the spacing, so that dense fluid has no holes

export function rgbOf(hex) {
  return [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16) / 255);
}

/** A colour of a palette at t in [0, 1], linear between its entries. */
function mixed(palette, t) {
  const place = t * (palette.length - 1);
  const k = Math.min(Math.floor(place), palette.length - 2);
  return palette[k].map((v, c) => v + (place - k) * (palette[k + 1][c] - v));
}

function program(gl, vertex, fragment) {
  const made = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(made, shader);
  }
  gl.linkProgram(made);
  if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(made));
  return made;
}

/** Rows of a disc of that diameter [pixels]: [y, from, to] about its centre's pixel; a square where it is hardly more. */
function stamp(diameter) {
  const side = Math.max(1, Math.round(diameter));
  const low = -Math.floor((side - 1) / 2);
  const middle = low + (side - 1) / 2;
  const rows = [];
  for (let y = low; y < low + side; ++y) {
    const half = side < 4 ? side / 2 : Math.sqrt(Math.max(0, (side * side) / 4 - (y - middle) ** 2));
    rows.push([y, Math.ceil(middle - half), Math.floor(middle + half)]);
  }
  return rows;
}

const packed = (color) => (255 << 24 | Math.round(255 * color[2]) << 16 | Math.round(255 * color[1]) << 8 | Math.round(255 * color[0])) >>> 0;

/** A shape of a page cut into triangles, in its own frame. */
function cut(rings) {
  const flat = rings.flat();
  const holes = [];
  let count = 0;
  for (const ring of rings) {
    if (count > 0) holes.push(count);
    count += ring.length / 2;
  }
  const edges = [];
  let first = 0;
  for (const ring of rings) {
    const n = ring.length / 2;
    for (let i = 0; i < n; ++i) edges.push(first + i, first + ((i + 1) % n));
    first += n;
  }
  return { points: flat, triangles: earcut(flat, holes), edges };
}

/** A list of points with colours that grows as needed. */
class Batch {
  constructor() {
    this.data = new Float32Array(1 << 14);
    this.count = 0;
  }
  add(x, y, color) {
    let at = 5 * this.count++;
    if (at + 5 > this.data.length) {
      const larger = new Float32Array(2 * this.data.length);
      larger.set(this.data);
      this.data = larger;
    }
    this.data[at++] = x;
    this.data[at++] = y;
    this.data[at++] = color[0];
    this.data[at++] = color[1];
    this.data[at] = color[2];
  }
}

export class Painter {
  /** Throws Error where the browser has no WebGL2. */
  constructor(canvas, page) {
    this.canvas = canvas;
    this.page = page;
    const gl = canvas.getContext('webgl2', { antialias: false, alpha: false, preserveDrawingBuffer: true });
    if (!gl) throw new Error('this browser has no WebGL2');
    this.gl = gl;
    this.particles = program(gl, kParticleVertex, kParticleFragment);
    this.shapes = program(gl, kShapeVertex, kShapeFragment);
    this.picture = { program: program(gl, kPictureVertex, kPictureFragment), array: gl.createVertexArray(), texture: null, pixels: new Uint32Array(0) };
    this.cuts = page.shapes.map(cut);
    const [x0, y0, x1, y1] = page.box;
    this.box = [x0, y0, x1 - x0, y1 - y0];
    this.palettes = Object.fromEntries(Object.entries(page.palettes).map(([name, list]) => [name, list.map(rgbOf)]));
    this.texture = this.makePalette(this.palettes.viridis);
    this.buffers = [0, 1, 2].map(() => ['x', 'y', 'value'].map(() => gl.createBuffer()));
    this.arrays = this.buffers.map((buffers) => this.particleArray(buffers));
    this.shapeBuffer = gl.createBuffer();
    this.shapeArray = this.makeShapeArray();
    this.fixed = this.fixedBodies();
    this.resetView();
  }
  makePalette(colors) {
    const gl = this.gl;
    const texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    const pixels = new Uint8Array(colors.flatMap((c) => [...c.map((v) => Math.round(255 * v)), 255]));
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, colors.length, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, filter, gl.LINEAR);
    for (const wrap of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, wrap, gl.CLAMP_TO_EDGE);
    return texture;
  }
  particleArray(buffers) {
    const gl = this.gl;
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    ['x', 'y', 'value'].forEach((name, k) => {
      const place = gl.getAttribLocation(this.particles, name);
      gl.bindBuffer(gl.ARRAY_BUFFER, buffers[k]);
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, 1, name === 'value' ? gl.UNSIGNED_BYTE : gl.UNSIGNED_SHORT, true, 0, 0);
    });
    return array;
  }
  makeShapeArray() {
    const gl = this.gl;
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.shapeBuffer);
    for (const [name, size, offset] of [['at', 2, 0], ['tint', 3, 8]]) {
      const place = gl.getAttribLocation(this.shapes, name);
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, size, gl.FLOAT, false, 20, offset);
    }
    return array;
  }
  addBody(fills, lines, shape, x, y, angle) {
    const { points, triangles, edges } = this.cuts[shape];
    const c = Math.cos(angle);
    const s = Math.sin(angle);
    const put = (batch, k, color) => {
      const px = points[2 * k];
      const py = points[2 * k + 1];
      batch.add(x + c * px - s * py, y + s * px + c * py, color);
    };
    for (const k of triangles) put(fills, k, kFill);
    for (const k of edges) put(lines, k, kOutline);
  }
  fixedBodies() {
    const fills = new Batch();
    const lines = new Batch();
    for (const body of this.page.bodies) if (!body.moves) this.addBody(fills, lines, body.shape, ...body.pose);
    const [x0, y0, x1, y1] = this.page.box;
    const corners = [[[x0, y0], [x0, y1]], [[x1, y0], [x1, y1]], [[x0, y0], [x1, y0]], [[x0, y1], [x1, y1]]];
    corners.forEach((ends, side) => ends.forEach(([x, y]) => lines.add(x, y, this.page.closed[side] ? kOutline : kOpenSide)));
    return { fills, lines };
  }

  // ---- the view

  resetView() {
    const [x0, y0, x1, y1] = this.page.view;
    this.center = [(x0 + x1) / 2, (y0 + y1) / 2];
    this.zoom = 1;
  }
  resize(cssWidth, cssHeight) {
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    this.canvas.width = Math.max(1, Math.round(cssWidth * ratio));
    this.canvas.height = Math.max(1, Math.round(cssHeight * ratio));
  }
  /** Pixels of the canvas a metre. */
  get scale() {
    const [x0, y0, x1, y1] = this.page.view;
    return 0.97 * this.zoom * Math.min(this.canvas.width / (x1 - x0), this.canvas.height / (y1 - y0));
  }
  /** The point under a place of the canvas, in CSS pixels from its upper left. */
  pointAt(cssX, cssY) {
    const ratio = this.canvas.width / this.canvas.clientWidth;
    return [
      this.center[0] + (cssX * ratio - this.canvas.width / 2) / this.scale,
      this.center[1] - (cssY * ratio - this.canvas.height / 2) / this.scale,
    ];
  }
  zoomBy(factor, cssX = this.canvas.clientWidth / 2, cssY = this.canvas.clientHeight / 2) {
    const before = this.pointAt(cssX, cssY);
    this.zoom = Math.min(400, Math.max(0.2, this.zoom * factor));
    const after = this.pointAt(cssX, cssY);
    this.center = [this.center[0] + before[0] - after[0], this.center[1] + before[1] - after[1]];
  }
  panBy(cssX, cssY) {
    const ratio = this.canvas.width / this.canvas.clientWidth;
    this.center = [this.center[0] - (cssX * ratio) / this.scale, this.center[1] + (cssY * ratio) / this.scale];
  }

  // ---- drawing

  /** `look`: { by: 'speed' | 'pressure' | 'strain' | 'phase', phases: three colours }. */
  draw(frame, look) {
    const gl = this.gl;
    gl.viewport(0, 0, this.canvas.width, this.canvas.height);
    gl.clearColor(...kBackground, 1);
    gl.clear(gl.COLOR_BUFFER_BIT);
    const view = [...this.center, (2 * this.scale) / this.canvas.width, (2 * this.scale) / this.canvas.height];
    if (frame) this.drawAllParticles(frame, look, view);
    this.drawShapes(frame, look, view);
  }
  drawAllParticles(frame, look, view) {
    this.stamped = false;
    for (const kind of [0, 1]) {
      const species = frame.species[kind];
      if (species.id.length === 0) continue;
      const diameter = (kind === 0 ? kSpread * this.page.spacing : 2 * this.page.bulletRadius) * this.scale;
      const values = look.by === 'pressure' && kind === 0 ? species.value : species.speed;
      const plain = look.by === 'phase' || look.by === 'strain' ? look.phases[kind] : null;
      if (diameter < kStampedTo) this.stampParticles(species, values, diameter, plain);
      else {
        this.showStamped();
        this.drawParticles(species, kind, values, diameter, plain, view);
      }
    }
    this.showStamped();
  }
  stampParticles(species, values, diameter, plain) {
    const { width, height } = this.canvas;
    if (!this.stamped) {
      if (this.picture.pixels.length !== width * height) this.picture.pixels = new Uint32Array(width * height);
      this.picture.pixels.fill(packed(kBackground));
      this.stamped = true;
    }
    const pixels = this.picture.pixels;
    const colors = Uint32Array.from({ length: 256 }, (_, byte) => packed(plain ?? mixed(this.palettes.viridis, byte / 255)));
    const rows = stamp(Math.max(diameter, 1.5));
    const scale = this.scale;
    const ax = (this.box[2] / 65535) * scale;
    const ay = (this.box[3] / 65535) * scale;
    const bx = (this.box[0] - this.center[0]) * scale + width / 2;
    const by = (this.box[1] - this.center[1]) * scale + height / 2;
    const { x, y } = species;
    for (let i = 0; i < x.length; ++i) {
      const px = Math.floor(ax * x[i] + bx);
      const py = Math.floor(ay * y[i] + by);
      if (px < -kStampedTo || py < -kStampedTo || px > width + kStampedTo || py > height + kStampedTo) continue;
      const color = colors[values[i]];
      for (let r = 0; r < rows.length; ++r) {
        const row = py + rows[r][0];
        if (row < 0 || row >= height) continue;
        const to = Math.min(width - 1, px + rows[r][2]);
        for (let at = Math.max(0, px + rows[r][1]); at <= to; ++at) pixels[row * width + at] = color;
      }
    }
  }
  /** Puts what was stamped on the canvas. */
  showStamped() {
    if (!this.stamped) return;
    this.stamped = false;
    const gl = this.gl;
    const { width, height } = this.canvas;
    if (this.picture.size !== `${width} ${height}`) {
      if (this.picture.texture) gl.deleteTexture(this.picture.texture);
      this.picture.size = `${width} ${height}`;
      this.picture.texture = gl.createTexture();
      gl.bindTexture(gl.TEXTURE_2D, this.picture.texture);
      gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA8, width, height);
      for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, filter, gl.NEAREST);
    }
    gl.bindTexture(gl.TEXTURE_2D, this.picture.texture);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(this.picture.pixels.buffer));
    gl.useProgram(this.picture.program);
    gl.bindVertexArray(this.picture.array);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }
  drawParticles(species, kind, values, size, plain, view) {
    const gl = this.gl;
    gl.bindVertexArray(this.arrays[kind]);
    [species.x, species.y, values].forEach((column, k) => {
      gl.bindBuffer(gl.ARRAY_BUFFER, this.buffers[kind][k]);
      gl.bufferData(gl.ARRAY_BUFFER, column, gl.STREAM_DRAW);
    });
    gl.useProgram(this.particles);
    const at = (name) => gl.getUniformLocation(this.particles, name);
    gl.uniform4f(at('box'), ...this.box);
    gl.uniform4f(at('view'), ...view);
    gl.uniform1f(at('size'), size);
    gl.uniform3f(at('plain'), ...(plain ?? [-1, 0, 0]));
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    gl.drawArrays(gl.POINTS, 0, species.id.length);
  }
  drawShapes(frame, look, view) {
    const gl = this.gl;
    gl.useProgram(this.shapes);
    gl.uniform4f(gl.getUniformLocation(this.shapes, 'view'), ...view);
    gl.bindVertexArray(this.shapeArray);
    const fills = new Batch();
    const lines = new Batch();
    if (frame) {
      this.addSoft(frame, look, fills, lines);
      let at = 0;
      for (const body of this.page.bodies) {
        if (!body.moves) continue;
        this.addBody(fills, lines, body.shape, frame.bodies[at], frame.bodies[at + 1], frame.bodies[at + 2]);
        at += 3;
      }
    }
    for (const [batch, mode] of [[this.fixed.fills, gl.TRIANGLES], [fills, gl.TRIANGLES], [this.fixed.lines, gl.LINES], [lines, gl.LINES]]) {
      if (batch.count === 0) continue;
      gl.bindBuffer(gl.ARRAY_BUFFER, this.shapeBuffer);
      gl.bufferData(gl.ARRAY_BUFFER, batch.data.subarray(0, 5 * batch.count), gl.STREAM_DRAW);
      gl.drawArrays(mode, 0, batch.count);
    }
  }
  addSoft(frame, look, fills, lines) {
    const { corners, ends, strain } = frame.surface;
    const points = frame.species[2];
    const [x0, y0, width, height] = this.box;
    const px = (k) => x0 + (points.x[k] / 65535) * width;
    const py = (k) => y0 + (points.y[k] / 65535) * height;
    const colorOf = (palette, byte) => palette[Math.round((byte / 255) * 32)];
    const colorBy = (vertices, byte) => {
      if (look.by === 'phase') return look.phases[2];
      if (look.by !== 'speed') return colorOf(this.palettes.strain, byte);
      let sum = 0;
      for (const k of vertices) sum += points.speed[k];
      return colorOf(this.palettes.viridis, sum / vertices.length);
    };
    const triangles = corners.length / 3;
    for (let t = 0; t < triangles; ++t) {
      const vertices = corners.subarray(3 * t, 3 * t + 3);
      const color = colorBy(vertices, strain[t]);
      for (const k of vertices) fills.add(px(k), py(k), color);
    }
    this.addOutlines(corners, px, py, lines);
    for (let l = 0; l < ends.length / 2; ++l) this.addLink(ends[2 * l], ends[2 * l + 1], px, py, fills, colorBy(ends.subarray(2 * l, 2 * l + 2), strain[triangles + l]));
  }
  /** Edges that belong to one triangle alone. */
  addOutlines(corners, px, py, lines) {
    if (this.outlineOf !== corners) {
      const sides = new Map();
      for (let t = 0; t < corners.length; t += 3)
        for (let e = 0; e < 3; ++e) {
          const a = corners[t + e];
          const b = corners[t + ((e + 1) % 3)];
          const key = Math.min(a, b) * 2 ** 26 + Math.max(a, b);
          sides.set(key, sides.has(key) ? null : [a, b]);
        }
      this.outline = [...sides.values()].filter(Boolean);
      this.outlineOf = corners;
    }
    for (const side of this.outline) for (const k of side) lines.add(px(k), py(k), kOutline);
  }
  addLink(a, b, px, py, fills, color) {
    const half = this.halfThickness(a);
    const [ax, ay, bx, by] = [px(a), py(a), px(b), py(b)];
    const length = Math.hypot(bx - ax, by - ay) || 1;
    const nx = (-(by - ay) / length) * half;
    const ny = ((bx - ax) / length) * half;
    for (const [x, y] of [[ax + nx, ay + ny], [ax - nx, ay - ny], [bx + nx, by + ny], [bx + nx, by + ny], [ax - nx, ay - ny], [bx - nx, by - ny]])
      fills.add(x, y, color);
  }
  halfThickness(point) {
    let thickness = 0;
    for (const body of this.page.soft) if (body.first <= point) thickness = body.thickness;
    return Math.max(thickness / 2, 0.75 / this.scale);
  }
}
