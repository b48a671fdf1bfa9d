/* The player: which frame is shown, and when. */
const icons = { true: "M2 1h3.4v11H2zM7.6 1H11v11H7.6z", false: "M2.5 .8v11.4L12 6.5z" };

class Player {
  constructor() {
    this.frame = 0;
    this.time = meta.times[0];
    this.playing = this.recording = false; /* recording: at full quality, without a change of size */
    this.rate = 1;
    this.pictureTime = 1 / 30; /* s that a picture of the animation may take */
    this.plots = [];
    this.dirty = true;
    this.atEnd = () => {}; /* called once when the last frame has been shown */
  }
  show(frame) {
    this.frame = Math.min(lastFrame(), Math.max(0, frame));
    this.time = meta.times[this.frame];
    this.refresh();
  }
  refresh() {
    this.dirty = true;
    $("scrub").value = this.frame;
    $("time").innerHTML = "";
    $("time").append(meta.times[this.frame].toFixed(3) + " s");
    element($("time"), "span", { textContent: this.frameText() });
    this.showPlots();
  }
  showPlots() {
    for (const plot of this.plots) plot.show(this.frame);
  }
  frameText() {
    return `frame ${this.frame} of ${lastFrame()}`;
  }
  play(on) {
    this.playing = on && frameCount() > 1;
    if (this.playing && this.frame === lastFrame()) this.show(0);
    this.showIcon();
  }
  showIcon() {
    $("play").innerHTML = `<svg viewBox="0 0 13 13"><path d="${icons[this.playing]}"/></svg>`;
  }
  /* Pauses and goes on or back by some frames. */
  stepFrames(by) {
    this.play(false);
    this.show(this.frame + by);
  }
  /* Called once, when all is ready. */
  start() {}
  gestures() {
    return [];
  }
  /* A frame that a link names, and whether it plays on. */
  open(frame, playing) {
    this.show(frame);
    this.play(playing);
  }
  /* Choices of the speed: [value, text, title]. */
  speeds() {
    return [0.1, 0.25, 0.5, 1, 2, 4].map((rate) => [rate, `${rate} ×`]);
  }
  setSpeed(value) {
    this.rate = Number(value);
  }
  /* Buttons: [text, title, action]. */
  actions() {
    return [["PNG", "Save this picture", savePicture], ["WebM", "Record a film of all frames", recordFilm],
      ["Link", "Copy a link to this view", copyLink], ["?", "Keys", () => $("help").showModal()]];
  }
  /* Plays all frames once, for a film; then calls stop(). */
  film(button, stop) {
    button.disabled = true;
    this.show(0);
    this.play(true);
    this.atEnd = () => {
      this.play(false);
      button.disabled = false;
      stop();
    };
  }
  /* Plays on by some seconds of wall time; shows the last frame for 0.6 s and starts again. */
  advance(seconds) {
    const first = meta.times[0], last = meta.times[lastFrame()];
    this.time += this.rate * seconds;
    if (this.time > last + 0.6 * this.rate) {
      this.time = first;
      this.atEnd();
      this.atEnd = () => {};
    }
    const frame = Math.max(0, lastBefore(meta.times, this.time + 1e-9));
    if (frame === this.frame) return;
    this.frame = frame;
    this.refresh();
  }
}

/* Draws when something has changed. While the picture moves, the quality falls as far as 30 pictures a second
 * need; 0.3 s after the last change the picture is drawn at full quality. */
class Animation {
  constructor(renderer) {
    Object.assign(this, { renderer, level: -1, slow: 0, last: 0, changed: -1e9, coarse: false });
  }
  tick(now) {
    const passed = now - this.last;
    this.last = now;
    if (player.playing) player.advance(Math.min(0.1, passed / 1000));
    if (player.dirty) this.drawMoving(now, passed);
    else if (this.coarse && now - this.changed > 300) this.draw(0);
    requestAnimationFrame((time) => this.tick(time));
  }
  /* The level to begin with, from the time that a picture takes at level 1: the levels' times are about as 3 : 1 :
   * 0.6 : 0.35 : 0.25. */
  measureLevel() {
    const seconds = [0, 1].map(() => {
      const start = performance.now(), gl = this.renderer.gl;
      this.draw(1);
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4)); /* waits for the picture */
      return (performance.now() - start) / 1000;
    });
    return [3, 1, 0.6, 0.35].filter((part) => part * seconds[1] > player.pictureTime).length;
  }
  drawMoving(now, passed) {
    const moving = now - this.changed < 300 + passed; /* a slow draw makes the next tick late */
    if (moving && this.level < 0) this.level = this.measureLevel();
    this.slow = moving && passed > 36 ? this.slow + (passed > 150 ? 4 : 1) : 0;
    if (this.slow > 3 && this.level < levels.length - 1) {
      this.level++;
      this.slow = 0;
    }
    this.changed = now;
    this.draw(moving && !player.recording ? this.level : 0);
  }
  draw(level) {
    fitCanvas(this.renderer.gl.canvas, levels[level].scale);
    this.renderer.draw(player.frame, levels[level]);
    this.coarse = level > 0;
    player.dirty = false;
  }
}

/* Gives the canvas the size of its place on the page, in pixels of the device times a scale. */
function fitCanvas(canvas, scale) {
  const ratio = scale * Math.min(2, devicePixelRatio || 1);
  const width = Math.max(1, Math.round(canvas.clientWidth * ratio));
  const height = Math.max(1, Math.round(canvas.clientHeight * ratio));
  if (canvas.width !== width) canvas.width = width;
  if (canvas.height !== height) canvas.height = height;
}
