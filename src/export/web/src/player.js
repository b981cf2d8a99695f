// The player: a canvas, a clock, and what a hand or a keyboard does to them.
import { h, short, kColors } from './dom.js';
import { Painter, rgbOf } from './canvas.js';

const kSpeeds = [0.05, 0.1, 0.25, 0.5, 1, 2, 4];
const kAhead = 4; // frames unpacked before they are due
const kZoomStep = 1.25;

export class Player {
  /** Throws Error where there is no WebGL2. `onTime(seconds)` is told of every frame that is shown. */
  constructor(page, store, onTime) {
    this.page = page;
    this.store = store;
    this.onTime = onTime;
    this.canvas = h('canvas', { tabindex: 0, role: 'img', 'aria-label': 'The simulation; space plays, arrows step, plus and minus zoom' });
    this.painter = new Painter(this.canvas, page);
    this.index = 0;
    this.playing = false;
    this.speed = 1;
    this.drawn = 0; // frames that were put on the canvas
    this.phases = [kColors[0], kColors[4], kColors[3]].map(rgbOf);
    const names = page.scales.map((scale) => scale.name);
    this.by = names.includes(page.color) ? page.color : names[0] ?? 'phase';
    if (page.soft.length > 0 && !page.spacing && !page.bulletRadius) this.by = 'strain';
    this.element = h('section', { class: 'player' }, h('div', { class: 'stage' }, this.canvas, (this.bar = h('div', { class: 'scale' }))), this.makeControls());
    this.listen();
    this.showScale();
  }

  // ---- what stands below the canvas

  makeControls() {
    const last = this.store.count - 1;
    this.playButton = h('button', { type: 'button', class: 'play', 'aria-label': 'Play', click: () => this.toggle() }, '\u25B6');
    this.slider = h('input', { type: 'range', min: 0, max: last, step: 1, value: 0, 'aria-label': 'Frame', input: () => { this.pause(); this.show(Number(this.slider.value)); } });
    this.clock = h('output', { class: 'clock' });
    this.speedBox = h('select', { 'aria-label': 'Speed', change: () => { this.speed = Number(this.speedBox.value); } },
      kSpeeds.map((speed) => h('option', { value: speed, selected: speed === 1 }, `${speed}\u00D7`)));
    this.colorBox = h('select', { 'aria-label': 'Colour', change: () => this.colorBy(this.colorBox.value) },
      [...this.page.scales.map((scale) => scale.name), 'phase'].map((name) => h('option', { value: name, selected: name === this.by }, `colour: ${name}`)));
    const fit = h('button', { type: 'button', 'aria-label': 'Whole view', click: () => { this.painter.resetView(); this.redraw(); } }, 'Fit');
    return h('div', { class: 'controls' }, this.playButton, this.slider, this.clock, this.speedBox, this.colorBox, fit);
  }
  get scale() {
    return this.page.scales.find((scale) => scale.name === this.by);
  }
  showScale() {
    const scale = this.scale;
    this.bar.replaceChildren();
    if (!scale) {
      const there = [['fluid', this.page.spacing], ['bullets', this.page.bulletRadius], ['soft bodies', this.page.soft.length > 0]];
      there.forEach(([name, isThere], k) => isThere && this.bar.append(h('span', { class: 'phase' }, h('i', { style: `background:${[kColors[0], kColors[4], kColors[3]][k]}` }), name)));
      return;
    }
    const colors = this.page.palettes[scale.name === 'strain' ? 'strain' : 'viridis'];
    const number = (value) => short(value * scale.factor);
    this.bar.append(h('span', {}, number(scale.low)), h('i', { class: 'bar', style: `background:linear-gradient(to right,${colors.join(',')})` }),
      h('span', {}, number(scale.high)), h('span', { class: 'label' }, scale.label));
  }
  colorBy(name) {
    this.by = name;
    this.colorBox.value = name;
    this.showScale();
    this.redraw();
  }

  // ---- time

  async start() {
    this.fit();
    new ResizeObserver(() => this.fit()).observe(this.canvas.parentElement);
    await this.show(0);
  }
  /** Shows frame `k`, once it is unpacked, unless another was asked for since. */
  async show(k) {
    const index = Math.max(0, Math.min(this.store.count - 1, k));
    this.wanted = index;
    this.index = index;
    this.slider.value = index;
    this.clock.textContent = `${this.store.times[index].toFixed(3)} s`;
    const frame = this.store.ready(index) ?? (await this.store.get(index));
    if (this.wanted !== index) return;
    this.frame = frame;
    this.redraw();
    this.onTime?.(this.store.times[index]);
  }
  redraw() {
    this.painter.draw(this.frame, { by: this.by, phases: this.phases });
    if (this.frame) ++this.drawn;
  }
  toggle() {
    if (this.playing) this.pause();
    else this.play();
  }
  play() {
    if (this.playing || this.store.count < 2) return;
    if (this.index >= this.store.count - 1) this.index = 0;
    this.playing = true;
    this.time = this.store.times[this.index];
    this.showPlaying();
    this.last = null;
    requestAnimationFrame((now) => this.tick(now));
  }
  pause() {
    this.playing = false;
    this.showPlaying();
  }
  showPlaying() {
    this.playButton.textContent = this.playing ? '\u23F8' : '\u25B6';
    this.playButton.setAttribute('aria-label', this.playing ? 'Pause' : 'Play');
  }
  tick(now) {
    if (!this.playing) return;
    const passed = this.last === null ? 0 : Math.min(0.25, (now - this.last) / 1000);
    this.last = now;
    const time = this.time + passed * this.speed;
    const due = this.store.at(time);
    const end = this.store.count - 1;
    for (let k = due; k <= Math.min(due + kAhead, end); ++k) if (!this.store.ready(k)) this.store.get(k);
    // The clock waits for a frame that is not unpacked yet, rather than to jump.
    if (this.store.ready(due)) {
      this.time = time;
      if (due !== this.index || !this.frame) this.show(due);
    }
    if (due >= end && this.index >= end) return this.pause();
    requestAnimationFrame((next) => this.tick(next));
  }

  // ---- hands

  fit() {
    const stage = this.canvas.parentElement;
    const width = stage.clientWidth;
    const [x0, y0, x1, y1] = this.page.view;
    const height = Math.max(160, Math.min((width * (y1 - y0)) / (x1 - x0), 0.66 * window.innerHeight));
    this.canvas.style.height = `${height}px`;
    this.painter.resize(width, height);
    this.redraw();
  }
  listen() {
    const canvas = this.canvas;
    const place = (event) => {
      const box = canvas.getBoundingClientRect();
      return [event.clientX - box.left, event.clientY - box.top];
    };
    canvas.addEventListener('wheel', (event) => {
      event.preventDefault();
      this.painter.zoomBy(Math.exp(-0.0015 * event.deltaY), ...place(event));
      this.redraw();
    }, { passive: false });
    const pointers = new Map();
    canvas.addEventListener('pointerdown', (event) => {
      canvas.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, place(event));
    });
    canvas.addEventListener('pointermove', (event) => {
      const before = pointers.get(event.pointerId);
      if (!before) return;
      const now = place(event);
      const other = [...pointers].find(([id]) => id !== event.pointerId)?.[1];
      if (other) {
        const distance = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]) || 1;
        this.painter.zoomBy(distance(now) / distance(before), (now[0] + other[0]) / 2, (now[1] + other[1]) / 2);
      }
      const share = other ? 0.5 : 1;
      this.painter.panBy(share * (now[0] - before[0]), share * (now[1] - before[1]));
      pointers.set(event.pointerId, now);
      this.redraw();
    });
    for (const end of ['pointerup', 'pointercancel']) canvas.addEventListener(end, (event) => pointers.delete(event.pointerId));
    canvas.addEventListener('dblclick', () => { this.painter.resetView(); this.redraw(); });
    document.addEventListener('keydown', (event) => this.key(event));
  }
  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.target.closest?.('input[type=text], input[type=search], select, textarea, summary')) return;
    if (event.key === ' ' && event.target.closest?.('button')) return; // it presses the button
    const far = event.shiftKey ? 10 : 1;
    const step = (by) => { this.pause(); this.show(this.index + by); };
    const zoom = (factor) => { this.painter.zoomBy(factor); this.redraw(); };
    const actions = {
      ' ': () => this.toggle(),
      ArrowRight: () => step(far), ArrowLeft: () => step(-far),
      Home: () => step(-this.store.count), End: () => step(this.store.count),
      '+': () => zoom(kZoomStep), '=': () => zoom(kZoomStep), '-': () => zoom(1 / kZoomStep),
      0: () => { this.painter.resetView(); this.redraw(); },
    };
    if (!actions[event.key]) return;
    event.preventDefault();
    actions[event.key]();
  }
}
