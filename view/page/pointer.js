// SPDX-License-Identifier: Apache-2.0
// Mouse, pen and fingers over the picture.

const kStill = 5;     // pixels that a click or tap may wander
const kTurn = 0.0085; // radians per pixel

/// Turns, moves and zooms `camera`. `on`: {changed(), hover(x, y), leave(), click(x, y), grip(x, y, e)}, in pixels of the
/// canvas; what grip returns, if anything, gets the events of a drag with Alt in the camera's place.
export function followPointers(canvas, camera, on) {
  const down = new Map();
  let wandered = 0, moveGripped = null;
  const place = e => {
    const box = canvas.getBoundingClientRect();
    return [e.clientX - box.left, e.clientY - box.top];
  };
  const relative = ([x, y]) => [2 * x / canvas.clientWidth - 1, 1 - 2 * y / canvas.clientHeight];
  const aspect = () => canvas.clientWidth / canvas.clientHeight;

  canvas.addEventListener('pointerdown', e => {
    canvas.setPointerCapture(e.pointerId);
    down.set(e.pointerId, place(e));
    if (down.size === 1) wandered = 0;
    moveGripped = down.size === 1 && e.altKey ? on.grip(...place(e), e) : null;
    on.leave();
  });
  canvas.addEventListener('pointermove', e => {
    const at = place(e), before = down.get(e.pointerId);
    if (!before) return on.hover(...at);
    const [dx, dy] = [at[0] - before[0], at[1] - before[1]];
    wandered += Math.hypot(dx, dy);
    if (down.size === 1) {
      if (wandered <= kStill) return down.set(e.pointerId, at);
      if (moveGripped) {
        down.set(e.pointerId, at);
        return moveGripped(e);
      }
      if (e.buttons & 6 || e.shiftKey || e.ctrlKey || e.metaKey) camera.pan(dx / canvas.clientHeight, -dy / canvas.clientHeight);
      else camera.turn(-dx * kTurn, dy * kTurn);
    } else if (down.size === 2) {
      // Two fingers: their middle moves the scene, their distance zooms.
      const other = [...down].find(([id]) => id !== e.pointerId)[1];
      const apart = p => Math.max(10, Math.hypot(p[0] - other[0], p[1] - other[1]));
      camera.pan(dx / 2 / canvas.clientHeight, -dy / 2 / canvas.clientHeight);
      camera.zoom(apart(before) / apart(at), ...relative([(at[0] + other[0]) / 2, (at[1] + other[1]) / 2]), aspect());
      wandered += kStill;
    }
    down.set(e.pointerId, at);
    on.changed();
  });
  const up = e => {
    const at = down.get(e.pointerId);
    down.delete(e.pointerId);
    if (e.type === 'pointerup' && at && down.size === 0 && wandered <= kStill && e.button === 0) on.click(...at);
  };
  canvas.addEventListener('pointerup', up);
  canvas.addEventListener('pointercancel', up);
  canvas.addEventListener('pointerleave', () => on.leave());
  canvas.addEventListener('contextmenu', e => e.preventDefault());
  canvas.addEventListener('wheel', e => {
    e.preventDefault();
    const pixels = e.deltaY * (e.deltaMode === 1 ? 30 : e.deltaMode === 2 ? 300 : 1);
    camera.zoom(Math.exp(Math.max(-300, Math.min(300, pixels)) * 0.0012), ...relative(place(e)), aspect());
    on.changed();
  }, {passive: false});
}
