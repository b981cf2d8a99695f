// The frames of a run, unpacked when they are asked for. Their coding is described in src/export/frame_coder.h.

const kMostBytes = 384 * 2 ** 20; // of unpacked frames that are kept

function bytesOfBase64(text) {
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < bytes.length; ++i) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

async function inflate(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

class Reader {
  constructor(bytes) {
    this.bytes = bytes;
    this.view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    this.at = 0;
  }
  u32() {
    this.at += 4;
    return this.view.getUint32(this.at - 4, true);
  }
  varint() {
    let value = 0;
    for (let shift = 0; ; shift += 7) {
      const byte = this.bytes[this.at++];
      value |= (byte & 0x7f) << shift;
      if (byte < 0x80) return value >>> 0;
    }
  }
  plane(count) {
    this.at += count;
    return this.bytes.subarray(this.at - count, this.at);
  }
}

const kStep = 1;
const kBeside = 2;
const kValues = 4;

/** Places of the frame before, but for those that are gone. */
function placesLeft(reader, gone, stayed) {
  const stay = new Uint32Array(stayed);
  let place = 0;
  let next = 0;
  for (let g = 0; g < gone; ++g) {
    place += reader.varint();
    while (next < place) stay[next - g] = next++;
    ++next;
  }
  for (let k = next - gone; k < stayed; ++k) stay[k] = next++;
  return stay;
}

/** The `stayed` elements at `places` (null: the first ones), then zeros up to `count`. */
function follow(values, places, stayed, count) {
  const out = new values.constructor(count);
  if (!places) out.set(values.subarray(0, stayed));
  else for (let i = 0; i < places.length; ++i) out[i] = values[places[i]];
  return out;
}

function decodeCoordinate(reader, flags, before, step, stayed) {
  const n = before.length;
  const low = reader.plane(n);
  const high = reader.plane(n);
  const now = new Uint16Array(n);
  const nextStep = new Uint16Array(n);
  const byStep = flags & kStep ? -1 : 0; // masks: a loop without branches is several times as fast
  const byBeside = flags & kBeside ? -1 : 0;
  let beside = 0;
  for (let i = 0; i < n; ++i) {
    const coded = low[i] | (high[i] << 8);
    beside = ((coded >> 1) ^ -(coded & 1)) + (beside & byBeside);
    const value = before[i] + beside + (step[i] & byStep);
    now[i] = value;
    nextStep[i] = value - before[i];
  }
  for (let i = stayed; i < n; ++i) nextStep[i] = 0;
  return [now, nextStep];
}

function decodeBytes(reader, before) {
  const plane = reader.plane(before.length);
  const now = new Uint8Array(before.length);
  for (let i = 0; i < now.length; ++i) now[i] = before[i] + plane[i];
  return now;
}

const emptySpecies = () => ({
  id: new Uint32Array(0), x: new Uint16Array(0), y: new Uint16Array(0), dx: new Uint16Array(0), dy: new Uint16Array(0),
  speed: new Uint8Array(0), value: new Uint8Array(0),
});

function decodeSpecies(reader, before) {
  const n = reader.u32();
  const gone = reader.u32();
  const fresh = reader.u32();
  const flags = reader.u32();
  const stayed = n - fresh;
  const stay = gone > 0 ? placesLeft(reader, gone, stayed) : null;
  const kept = (values) => (stay || fresh > 0 ? follow(values, stay, stayed, n) : values);
  const id = kept(before.id);
  for (let i = stayed, last = 0; i < n; ++i) id[i] = last += reader.varint();
  const [x, dx] = decodeCoordinate(reader, flags, kept(before.x), kept(before.dx), stayed);
  const [y, dy] = decodeCoordinate(reader, flags, kept(before.y), kept(before.dy), stayed);
  const speed = decodeBytes(reader, kept(before.speed));
  return { id, x, y, dx, dy, speed, value: flags & kValues ? decodeBytes(reader, kept(before.value)) : new Uint8Array(0) };
}

function decodeBodies(reader, before) {
  const n = reader.u32();
  const bits = new Uint32Array(n);
  for (let shift = 0; shift < 32; shift += 8) {
    const plane = reader.plane(n);
    for (let i = 0; i < n; ++i) bits[i] |= plane[i] << shift;
  }
  if (before.length === n) for (let i = 0; i < n; ++i) bits[i] ^= before[i];
  return bits;
}

function decodeIndices(reader, count) {
  const out = new Uint32Array(count);
  for (let i = 0, last = 0; i < count; ++i) {
    const coded = reader.varint();
    out[i] = last = (last + ((coded >>> 1) ^ -(coded & 1))) >>> 0;
  }
  return out;
}

function decodeSurface(reader, before) {
  const triangles = reader.u32();
  const links = reader.u32();
  const same = reader.u32() === 1;
  const corners = same ? before.corners : decodeIndices(reader, 3 * triangles);
  const ends = same ? before.ends : decodeIndices(reader, 2 * links);
  const strain = decodeBytes(reader, same ? before.strain : new Uint8Array(triangles + links));
  return { corners, ends, strain };
}

const kBegin = () => ({
  species: [emptySpecies(), emptySpecies(), emptySpecies()],
  bodyBits: new Uint32Array(0),
  surface: { corners: new Uint32Array(0), ends: new Uint32Array(0), strain: new Uint8Array(0) },
});

/** A frame from its unpacked record and the frame before it (none for a key frame). */
export function decodeFrame(bytes, before) {
  const from = before ?? kBegin();
  const reader = new Reader(bytes);
  const species = from.species.map((s) => decodeSpecies(reader, s));
  const bodyBits = decodeBodies(reader, from.bodyBits);
  const surface = decodeSurface(reader, from.surface);
  return { species, bodyBits, bodies: new Float32Array(bodyBits.buffer), surface };
}

const sizeOf = (frame) => frame.species.reduce((sum, s) => sum + 14 * s.id.length, 0) + 4 * frame.bodies.length;

/** All frames of a page. Blocks of a key frame and its successors are unpacked as far as they are needed. */
export class FrameStore {
  /** `list`: rows [index, time, key, packed, unpacked, particles]; `elements`: one script element a block. */
  constructor(list, elements) {
    this.times = list.map((row) => row[1]);
    this.indices = list.map((row) => row[0]);
    this.particles = list.map((row) => row[5]);
    this.packedBytes = list.reduce((sum, row) => sum + row[3], 0);
    this.blocks = [];
    this.blockOf = [];
    list.forEach((row, k) => {
      if (k === 0 || row[2] === 1)
        this.blocks.push({ first: k, sizes: [], frames: [], element: elements[this.blocks.length], work: Promise.resolve() });
      const block = this.blocks[this.blocks.length - 1];
      block.sizes.push(row[3]);
      this.blockOf.push(block);
    });
    this.bytes = 0;
    this.recent = [];
  }
  get count() {
    return this.times.length;
  }
  /** The frame if it is unpacked. */
  ready(k) {
    const block = this.blockOf[k];
    return block.frames[k - block.first];
  }
  /** Frame `k`, unpacked. */
  get(k) {
    const block = this.blockOf[k];
    this.touch(block);
    const done = this.ready(k);
    if (done) return Promise.resolve(done);
    block.work = block.work.then(() => this.unpack(block, k - block.first));
    return block.work.then(() => this.ready(k) ?? this.get(k));
  }
  async unpack(block, upTo) {
    block.packed ??= bytesOfBase64(block.element.textContent);
    const packed = block.packed;
    while (block.frames.length <= upTo) {
      const k = block.frames.length;
      const before = block.frames[k - 1];
      const at = block.sizes.slice(0, k).reduce((sum, size) => sum + size, 0);
      const frame = decodeFrame(await inflate(packed.subarray(at, at + block.sizes[k])), before);
      if (block.frames.length !== k) continue; // it was let go in the meantime
      block.frames.push(frame);
      this.bytes += sizeOf(frame);
    }
  }
  touch(block) {
    if (this.recent[this.recent.length - 1] === block) return;
    this.recent = this.recent.filter((other) => other !== block);
    this.recent.push(block);
    while (this.bytes > kMostBytes && this.recent.length > 2) {
      const old = this.recent.shift();
      this.bytes -= old.frames.reduce((sum, frame) => sum + sizeOf(frame), 0);
      old.frames = [];
      old.packed = null;
    }
  }
  /** The last frame at or before a time. */
  at(time) {
    let low = 0;
    let high = this.count - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.times[middle] <= time + 1e-12) low = middle;
      else high = middle - 1;
    }
    return low;
  }
}
