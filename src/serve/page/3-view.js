// The canvas: where it looks, what it draws, what fingers and keys do to it.
const view = (() => {
  const canvas = document.getElementById("map"), context = canvas.getContext("2d");
  const look = { x: 0, y: 0, scale: 40, mode: "fit" };  // metres at the centre, pixels a metre; fit, follow or free
  const goal = { x: 0, y: 0, scale: 40 };
  const ink = {
    light: { scan: "#e5484d", way: "#2f6fed", tail: "#2f6fed", loop: "#1a9d5c", robot: "#2f6fed", other: "#c77700", edge: "#fff", sigma: "rgba(47,111,237,.20)", page: "#dfe4ea" },
    dark: { scan: "#ff8b6b", way: "#6c9bff", tail: "#6c9bff", loop: "#3ecf8e", robot: "#6c9bff", other: "#ffb454", edge: "#0d1014", sigma: "rgba(108,155,255,.25)", page: "#0d1014" },
  };
  let theme = "light", ratio = 1, asked = false, settled = true, aim = null, on_pose = null, on_mode = () => {}, frames = 0, last = 0;
  const pointers = new Map();

  const px = (x) => canvas.width / 2 + (x - look.x) * look.scale * ratio;
  const py = (y) => canvas.height / 2 - (y - look.y) * look.scale * ratio;
  const to_world = (event) => {
    const box = canvas.getBoundingClientRect();
    return [look.x + (event.clientX - box.left - box.width / 2) / look.scale, look.y - (event.clientY - box.top - box.height / 2) / look.scale];
  };

  function ask() {
    if (asked) return;
    asked = true;
    requestAnimationFrame((now) => { asked = false; draw(now); });
  }

  function set_mode(mode) {
    if (mode !== look.mode) {
      look.mode = mode;
      on_mode(mode);
    }
    ask();
  }

  function fit() {
    const scan = world.state.scan, known = world.state.bounds;
    let b = known;
    if (!b && !scan) return;
    if (!b) b = [scan.x - 5, scan.y - 5, scan.x + 5, scan.y + 5];
    // Beside the buttons, or below them: where the map is larger.
    const panel = document.getElementById("panel"), tools = document.getElementById("tools").getBoundingClientRect();
    const narrow = canvas.clientWidth < 640, open = panel.classList.contains("open"), width = canvas.clientWidth, height = canvas.clientHeight;
    const low_cards = ["alarm", "replay"].map((id) => document.getElementById(id)).filter((card) => !card.hidden && card.offsetTop > height / 2);
    const bottom = narrow && open ? panel.offsetHeight + 16 : Math.max(narrow ? 24 : 64, ...low_cards.map((card) => height - card.offsetTop + 12)), beside = open && !narrow ? width - panel.offsetLeft : width - tools.left;
    const rooms = [[16, beside + 16, 92, bottom]];
    if (narrow) rooms.push([16, 16, tools.bottom + 8, bottom]);
    goal.scale = 0;
    for (const [left, right, top, low] of rooms) {
      const scale = Math.max(2, Math.min(120, (width - left - right) / (b[2] - b[0] + 0.4), (height - top - low) / (b[3] - b[1] + 0.4)));
      if (scale <= goal.scale) continue;
      goal.scale = scale;
      goal.x = (b[0] + b[2]) / 2 + (right - left) / 2 / scale;
      goal.y = (b[1] + b[3]) / 2 + (top - low) / 2 / scale;
    }
  }

  /// Moves a part of the way to where it should look; true when it is there.
  function approach(now) {
    const scan = world.state.scan;
    if (look.mode === "fit") fit();
    else if (look.mode === "follow" && scan) Object.assign(goal, { x: scan.x, y: scan.y, scale: look.scale });
    else return true;
    const still = matchMedia("(prefers-reduced-motion: reduce)").matches || frames < 3;
    const share = still ? 1 : 1 - Math.exp(-Math.min(now - last, 100) / 140);
    const off = Math.hypot(goal.x - look.x, goal.y - look.y) * look.scale + 200 * Math.abs(Math.log(goal.scale / look.scale));
    look.x += (goal.x - look.x) * share;
    look.y += (goal.y - look.y) * share;
    look.scale *= Math.pow(goal.scale / look.scale, share);
    return off < 0.3;
  }

  function draw_map() {
    const size = world.kSide * world.state.resolution;
    context.imageSmoothingEnabled = look.scale * ratio * world.state.resolution < 2.5;
    for (const chunk of world.state.chunks.values()) {
      const x0 = Math.round(px(chunk.ci * size)), x1 = Math.round(px((chunk.ci + 1) * size));
      const y0 = Math.round(py((chunk.ck + 1) * size)), y1 = Math.round(py(chunk.ck * size));
      if (x1 < 0 || y1 < 0 || x0 > canvas.width || y0 > canvas.height) continue;
      context.drawImage(chunk.canvas, x0, y0, x1 - x0, y1 - y0);
    }
  }

  function line(points, colour, width, gap) {
    context.beginPath();
    // Where nobody knows how it went on there is no line.
    let before = null;
    for (const p of points) {
      if (before && Math.hypot(p[0] - before[0], p[1] - before[1]) < gap) context.lineTo(px(p[0]), py(p[1]));
      else if (p[0] === p[0]) context.moveTo(px(p[0]), py(p[1]));
      before = p[0] === p[0] ? p : null;
    }
    context.strokeStyle = colour;
    context.lineWidth = width * ratio;
    context.stroke();
  }

  function draw_loops(now) {
    let young = false;
    for (const loop of world.state.loops) {
      const a = world.state.path[loop.from], b = world.state.path[loop.to];
      if (!a || !b || a[0] !== a[0] || b[0] !== b[0]) continue;
      const age = (now - loop.born) / 2500;
      young = young || age < 1;
      context.globalAlpha = age < 1 ? 1 : 0.5;
      line([a, b], ink[theme].loop, age < 1 ? 2 + 4 * (1 - age) : 1.5);
      if (age < 1) {
        context.beginPath();
        context.arc(px(b[0]), py(b[1]), (6 + 26 * age) * ratio, 0, 7);
        context.globalAlpha = 1 - age;
        context.stroke();
      }
    }
    context.globalAlpha = 1;
    return young;
  }

  function draw_scan(scan) {
    const c = Math.cos(scan.theta), s = Math.sin(scan.theta), size = Math.max(2, Math.min(5, look.scale * 0.06)) * ratio;
    context.fillStyle = ink[theme].scan;
    for (let i = 0; i < scan.points.length; i += 2) {
      const x = scan.points[i] * scan.unit, y = scan.points[i + 1] * scan.unit;
      context.fillRect(px(scan.x + c * x - s * y) - size / 2, py(scan.y + s * x + c * y) - size / 2, size, size);
    }
  }

  /// Two sigma of the position, and of the heading as a wedge.
  function draw_sigma(scan) {
    const half = (scan.xx + scan.yy) / 2, off = Math.hypot((scan.xx - scan.yy) / 2, scan.xy);
    const major = 2 * Math.sqrt(Math.max(0, half + off)), minor = 2 * Math.sqrt(Math.max(0, half - off));
    const turn = 0.5 * Math.atan2(2 * scan.xy, scan.xx - scan.yy), most = 50;
    context.fillStyle = ink[theme].sigma;
    context.beginPath();
    context.ellipse(px(scan.x), py(scan.y), Math.min(major, most) * look.scale * ratio, Math.min(minor, most) * look.scale * ratio, -turn, 0, 7);
    context.fill();
    const wedge = Math.min(Math.PI, 2 * Math.sqrt(Math.max(0, scan.tt)));
    if (wedge < 0.005) return;
    context.beginPath();
    context.moveTo(px(scan.x), py(scan.y));
    context.arc(px(scan.x), py(scan.y), 44 * ratio, -scan.theta - wedge, -scan.theta + wedge);
    context.fill();
  }

  function arrow(x, y, theta, colour, size) {
    context.save();
    context.translate(px(x), py(y));
    context.rotate(-theta);
    context.scale(size * ratio, size * ratio);
    context.beginPath();
    context.moveTo(1.25, 0);
    context.lineTo(-0.85, 0.8);
    context.lineTo(-0.4, 0);
    context.lineTo(-0.85, -0.8);
    context.closePath();
    context.fillStyle = colour;
    context.strokeStyle = ink[theme].edge;
    context.lineWidth = 0.28;
    context.lineJoin = "round";
    context.stroke();
    context.fill();
    context.restore();
  }

  function draw_scale() {
    const steps = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200];
    const length = steps.find((s) => s * look.scale >= 50) ?? 500;
    document.querySelector("#scale i").style.width = length * look.scale + "px";
    document.getElementById("scale-text").textContent = length < 1 ? length * 100 + " cm" : length + " m";
  }

  function draw(now) {
    const rest = approach(now), scan = world.state.scan;
    context.fillStyle = ink[theme].page;
    context.fillRect(0, 0, canvas.width, canvas.height);
    draw_map();
    context.lineCap = context.lineJoin = "round";
    const young = draw_loops(now);
    context.globalAlpha = 0.8;
    const gap = 1.5, path = world.state.path;
    line(path, ink[theme].way, 2, path.length > 2 ? gap : Infinity);
    line(world.state.tail, ink[theme].tail, 2, gap);
    context.globalAlpha = 1;
    if (scan) {
      if (scan.state !== "lost") draw_sigma(scan);
      for (const at of world.state.hypotheses.slice(1)) {
        context.globalAlpha = 0.35 + 0.5 * Math.min(1, at.confidence);
        arrow(at.x, at.y, at.theta, ink[theme].other, 11);
      }
      const faint = scan.state === "lost" || world.is_guess(scan);
      context.globalAlpha = faint ? 0.4 : 1;
      draw_scan(scan);
      context.globalAlpha = faint || document.body.dataset.line === "off" ? 0.35 : 1;
      arrow(scan.x, scan.y, scan.theta, ink[theme].robot, 13);
      context.globalAlpha = 1;
    }
    if (aim) arrow(aim.x, aim.y, aim.theta, ink[theme].loop, 16);
    draw_scale();
    last = now;
    frames += scan ? 1 : 0;
    settled = rest;
    if (!rest || young) ask();
  }

  function zoom(factor, event) {
    const before = event ? to_world(event) : [look.x, look.y];
    look.scale = Math.max(1, Math.min(800, look.scale * factor));
    if (look.mode === "follow") return ask();
    const after = event ? to_world(event) : before;
    look.x += before[0] - after[0];
    look.y += before[1] - after[1];
    set_mode("free");
  }

  function pan(dx, dy) {
    look.x -= dx / look.scale;
    look.y += dy / look.scale;
    set_mode("free");
  }

  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, event);
    canvas.classList.add("held");
    if (on_pose && pointers.size === 1) {
      const [x, y] = to_world(event);
      aim = { x, y, theta: world.state.scan ? world.state.scan.theta : 0 };
    } else {
      aim = null;
    }
    ask();
  });
  canvas.addEventListener("pointermove", (event) => {
    const before = pointers.get(event.pointerId);
    if (!before) return;
    if (aim) {
      const [x, y] = to_world(event);
      if (Math.hypot(x - aim.x, y - aim.y) * look.scale > 12) aim.theta = Math.atan2(y - aim.y, x - aim.x);
      ask();
    } else if (pointers.size === 1) {
      if (!on_pose) pan(event.clientX - before.clientX, event.clientY - before.clientY);
    } else {
      const other = [...pointers.values()].find((p) => p.pointerId !== event.pointerId);
      const gap = (p) => Math.max(10, Math.hypot(p.clientX - other.clientX, p.clientY - other.clientY));
      const middle = { clientX: (event.clientX + other.clientX) / 2, clientY: (event.clientY + other.clientY) / 2 };
      if (look.mode !== "follow") pan((event.clientX - before.clientX) / 2, (event.clientY - before.clientY) / 2);
      zoom(gap(event) / gap(before), middle);
    }
    pointers.set(event.pointerId, event);
  });
  const release = (event) => {
    pointers.delete(event.pointerId);
    if (!pointers.size) canvas.classList.remove("held");
    const set = on_pose, pose = aim;
    if (event.type === "pointerup" && pose && set) set(pose);
    aim = null;
    ask();
  };
  canvas.addEventListener("pointerup", release);
  canvas.addEventListener("pointercancel", release);
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    zoom(Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.0015)), event);
  }, { passive: false });
  canvas.addEventListener("dblclick", (event) => { if (!on_pose) zoom(1.8, event); });

  function resize() {
    ratio = Math.min(3, devicePixelRatio || 1);
    canvas.width = Math.round(canvas.clientWidth * ratio);
    canvas.height = Math.round(canvas.clientHeight * ratio);
    ask();
  }
  addEventListener("resize", resize);
  resize();

  return {
    ask, zoom, pan, set_mode, look,
    get frames() { return frames; },
    get settled() { return settled; },
    theme(name) { theme = name; world.choose(name); ask(); },
    aim_for(callback) { on_pose = callback; aim = null; canvas.classList.toggle("aim", !!callback); ask(); },
    screen_of(x, y) { return [px(x) / ratio, py(y) / ratio]; },
    set on_mode(callback) { on_mode = callback; },
  };
})();
