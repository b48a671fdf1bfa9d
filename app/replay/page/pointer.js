/* Mouse and touch: one pointer orbits (with the right button or shift: pans), two pointers zoom and pan. */
function controlCamera(renderer) {
  const canvas = $("scene"), camera = renderer.camera, pointers = new Map();
  const spread = () => {
    const [a, b] = [...pointers.values()];
    return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, size: Math.hypot(a.x - b.x, a.y - b.y) || 1 };
  };
  canvas.addEventListener("pointerdown", (e) => {
    canvas.setPointerCapture(e.pointerId);
    pointers.set(e.pointerId, { x: e.clientX, y: e.clientY });
  });
  canvas.addEventListener("pointermove", (e) => {
    const was = pointers.get(e.pointerId);
    if (!was) return;
    const before = pointers.size === 2 && spread(), dx = e.clientX - was.x, dy = e.clientY - was.y;
    pointers.set(e.pointerId, { x: e.clientX, y: e.clientY });
    if (before) {
      const after = spread();
      camera.zoom(before.size / after.size);
      camera.pan(after.x - before.x, after.y - before.y, canvas.clientHeight);
    } else if (e.buttons & 6 || e.shiftKey) camera.pan(dx, dy, canvas.clientHeight);
    else camera.orbit(dx, dy);
    player.dirty = true;
  });
  for (const event of ["pointerup", "pointercancel"]) canvas.addEventListener(event, (e) => pointers.delete(e.pointerId));
  canvas.addEventListener("contextmenu", (e) => e.preventDefault());
  canvas.addEventListener("wheel", (e) => {
    e.preventDefault();
    camera.zoom(Math.exp((e.deltaMode ? 0.04 : 0.0012) * e.deltaY));
    player.dirty = true;
  }, { passive: false });
  canvas.addEventListener("dblclick", () => {
    camera.reset();
    player.dirty = true;
  });
}
