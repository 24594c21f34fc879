// Words and buttons around the map.
(() => {
  const el = (id) => document.getElementById(id), root = document.documentElement;
  const began = performance.now();
  let status = null, last_scan = 0, offline = false, sliding = false, aiming = false, first_picture = null;

  const words = {
    waiting: ["Waiting", "for the first scan"],
    initialising: ["Starting", "no scan so far had enough returns to begin a map"],
    ok: ["Tracking", ""],
    degraded: ["Unsure", "much of the scan is not explained by the map"],
    ambiguous: ["Ambiguous", "a direction is open, as along a bare corridor"],
    lost: ["Lost", "the pose shown is only a prediction"],
    stalled: ["No scans", ""],
    told: ["Placed by hand", "shown there until the map says better"],
    looking: ["Looking for itself", "drive on: a place that is known again joins the map"],
    offline: ["Not connected", "trying again"],
  };
  // On a map that was there before.
  const known_words = {
    initialising: ["Looking for itself", "on the whole map"],
    ambiguous: ["Ambiguous", "several places look alike: drive on"],
    looking: ["Looking for itself", "on the whole map"],
  };

  function toast(text, bad) {
    const box = document.createElement("div");
    box.textContent = text;
    box.className = bad ? "bad" : "";
    el("toasts").append(box);
    setTimeout(() => box.remove(), bad ? 7000 : 4000);
  }
  const answer = (ok, text) => toast(text, !ok);

  // Themes: what the system wants, until somebody chooses.
  const prefers = matchMedia("(prefers-color-scheme: dark)");
  let chosen = null;
  try { chosen = localStorage.getItem("theme"); } catch { /* a browser that keeps nothing */ }
  function show_theme() {
    const name = chosen ?? (prefers.matches ? "dark" : "light");
    root.dataset.theme = name;
    view.theme(name);
  }
  prefers.addEventListener("change", show_theme);
  el("theme").onclick = () => {
    chosen = root.dataset.theme === "dark" ? "light" : "dark";
    try { localStorage.setItem("theme", chosen); } catch { /* the same */ }
    show_theme();
  };

  function show_state() {
    const scan = world.state.scan, age = (performance.now() - last_scan) / 1000;
    let name = offline ? "offline" : status && !scan ? status.state : scan ? scan.state : "waiting";
    const replay = status && status.replay;  // a log that is held, or has ended, is no sensor that is silent
    if (!offline && status && !(replay && scan) && (status.state === "stalled" || status.state === "waiting")) name = status.state;
    const ended = replay && replay.duration_s > 0 && replay.time_s >= replay.duration_s - 0.05;
    const unplaced = scan && !scan.placed && !offline;
    const word = unplaced && name === "degraded" ? "told" : unplaced && name === "lost" ? "looking" : name, known = !!(status && status.known_map);
    const [title, text] = (known && known_words[word]) || words[word] || words.waiting;
    el("state").dataset.state = name;
    el("state-name").textContent = title;
    el("state-source").textContent = status ? status.source.split("/").pop() : "";
    const where = scan ? `${scan.x.toFixed(2)}, ${scan.y.toFixed(2)} m, ${(scan.theta * 180 / Math.PI).toFixed(0)}\u00b0` : "";
    el("state-text").textContent = name === "stalled" ? `the last one came ${Math.round(status.age_s)} s ago: cable, power, motor?` : ended ? "the log ends here" : text || where;
    el("alarm").hidden = !(name === "lost" || name === "offline" || name === "stalled") || (name === "offline" && age < 2);
    el("alarm-name").textContent = title;
    el("alarm-text").textContent = name === "lost" ? (known ? "What the sensor sees does not fit the map there. It looks everywhere. Or tell it where it is." : "Drive on: a place that is known again brings it back. Or tell it where it is.") :
      name === "stalled" ? "The sensor is silent. It is taken up again as soon as it speaks." : "The program has ended, or the network is down. This page connects by itself.";
    el("alarm-find").hidden = name !== "lost" || unplaced;
    document.body.dataset.line = offline ? "off" : "on";
    document.title = (name === "ok" ? "" : title + " \u2013 ") + "phasescan";
  }

  function show_scan(scan) {
    el("n-latency").textContent = scan.latency.toFixed(scan.latency < 10 ? 1 : 0) + " ms";
    el("n-explained").textContent = Math.round(100 * scan.explained) + " %";
    const places = world.is_guess(scan) ? `one of ${world.state.hypotheses.length} places` : "";
    el("n-pose").textContent = places || `${scan.x.toFixed(3)} m, ${scan.y.toFixed(3)} m, ${(scan.theta * 180 / Math.PI).toFixed(1)}\u00b0`;
    const sigma = (v) => 100 * Math.sqrt(Math.max(0, v)), cm = (v) => v < 999 ? v.toFixed(1) : "> 999";
    const turn = Math.sqrt(Math.max(0, scan.tt)) * 180 / Math.PI;
    el("n-sigma").textContent = places ? "\u2013" : `${cm(sigma(scan.xx))} cm, ${cm(sigma(scan.yy))} cm, ${turn < 180 ? turn.toFixed(2) : "> 180"}\u00b0`;
  }

  const clock = (s) => `${Math.floor(s / 60)}:${String(Math.floor(s % 60)).padStart(2, "0")}`;
  function show_messages(all) {
    const list = el("messages"), text = all.map((m) => m.uptime_s + m.text).join("\n");
    if (list.dataset.text === text) return;
    list.dataset.text = text;
    list.replaceChildren(...all.slice().reverse().map((m) => {
      const item = document.createElement("li"), time = document.createElement("time"), what = document.createElement("span");
      time.textContent = clock(m.uptime_s);
      what.textContent = m.text;
      item.append(time, what);
      return item;
    }));
  }

  function show_status(now) {
    status = now;
    el("n-scans").textContent = now.scans.toLocaleString("en").replace(/,/g, "\u202f") + (now.dropped ? ` (${now.dropped} left out)` : "");
    el("n-rate").textContent = now.rate_hz.toFixed(1) + " Hz";
    el("n-way").textContent = now.path_m.toFixed(now.path_m < 100 ? 1 : 0) + " m";
    el("n-loops").textContent = now.loops;
    show_messages(now.messages);
    const can = now.can ?? {};
    el("save").disabled = !can.save;
    el("explained-name").textContent = now.known_map ? "sure" : "explained";
    el("record").disabled = !can.record;
    el("set-pose").disabled = el("pose").disabled = !can.set_pose;
    el("record").classList.toggle("recording", !!now.recording);
    el("record-text").textContent = now.recording ? "Stop recording" : "Record";
    const replay = now.replay && now.replay.duration_s > 0 ? now.replay : null;
    el("replay").hidden = !replay;
    document.body.classList.toggle("replays", !!replay);
    el("toasts").style.bottom = el("hint").style.bottom = replay ? "" : "24px";
    if (replay && !sliding) {
      el("time").value = 1000 * replay.time_s / replay.duration_s;
      el("time-text").textContent = `${clock(replay.time_s)} / ${clock(replay.duration_s)}`;
      if (replay.speed > 0 && document.activeElement !== el("speed")) el("speed").value = String(replay.speed);
      el("play").setAttribute("aria-label", replay.speed > 0 ? "Pause" : "Play");
      el("play-shape").setAttribute("d", replay.speed > 0 ? "M8 5v14M16 5v14" : "M7 4 20 12 7 20z");
    }
    show_state();
  }

  function aim(on) {
    aiming = on;
    el("pose").setAttribute("aria-pressed", on);
    el("hint").hidden = !on;
    if (on && innerWidth < 640) panel(false);
    view.aim_for(on ? (pose) => {
      aim(false);
      wire.ask("set_pose", pose, answer);
    } : null);
  }

  function panel(open) {
    el("panel").classList.toggle("open", open);
    el("more").setAttribute("aria-expanded", open);
    view.ask();
  }

  const find = () => wire.ask("relocalise", {}, answer);
  const name = () => el("name").value.trim();
  el("zoom-in").onclick = () => view.zoom(1.4);
  el("zoom-out").onclick = () => view.zoom(1 / 1.4);
  el("fit").onclick = () => view.set_mode("fit");
  el("follow").onclick = () => view.set_mode(view.look.mode === "follow" ? "free" : "follow");
  el("pose").onclick = el("set-pose").onclick = () => aim(!aiming);
  el("hint-cancel").onclick = () => aim(false);
  el("find").onclick = el("alarm-find").onclick = find;
  el("more").onclick = () => panel(!el("panel").classList.contains("open"));
  el("close").onclick = () => panel(false);
  el("save").onclick = () => wire.ask("save", { name: name() }, answer);
  el("record").onclick = () => (status && status.recording ? wire.ask("stop", {}, answer) : wire.ask("record", { name: name() }, answer));
  el("name").oninput = () => {
    const fine = /^([A-Za-z0-9][A-Za-z0-9._-]{0,63})?$/.test(name());
    el("name").setCustomValidity(fine ? "" : "letters, digits, - _ . and a letter or a digit first");
  };
  el("png").href = "/api/map.png" + wire.suffix;
  el("play").onclick = () => wire.ask("speed", { value: status && status.replay.speed > 0 ? 0 : +el("speed").value }, (ok, text) => ok || toast(text, true));
  el("speed").onchange = () => wire.ask("speed", { value: +el("speed").value }, (ok, text) => ok || toast(text, true));
  el("time").oninput = () => { sliding = true; if (status && status.replay) el("time-text").textContent = `${clock(status.replay.duration_s * el("time").value / 1000)} / ${clock(status.replay.duration_s)}`; };
  el("time").onchange = () => wire.ask("seek", { value: el("time").value / 1000 }, (ok, text) => { sliding = false; ok || toast(text, true); });
  view.on_mode = (mode) => {
    el("fit").setAttribute("aria-pressed", mode === "fit");
    el("follow").setAttribute("aria-pressed", mode === "follow");
  };
  addEventListener("keydown", (event) => {
    if (event.target.matches("input, select") || event.ctrlKey || event.metaKey || event.altKey) return;
    const keys = {
      "+": () => view.zoom(1.3), "=": () => view.zoom(1.3), "-": () => view.zoom(1 / 1.3), "0": () => view.set_mode("fit"),
      f: () => el("follow").click(), p: () => el("pose").click(), d: () => el("theme").click(), m: () => el("more").click(), Escape: () => aim(false),
      ArrowLeft: () => view.pan(60, 0), ArrowRight: () => view.pan(-60, 0), ArrowUp: () => view.pan(0, 60), ArrowDown: () => view.pan(0, -60),
    };
    const act = keys[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (act) act();
  });

  Object.assign(wire.on, {
    hello() { offline = false; world.clear(); show_state(); view.ask(); },
    status: show_status,
    scan(scan) {
      last_scan = performance.now();
      world.scan(scan);
      first_picture ??= Math.round(performance.now() - began);
      show_scan(scan);
      show_state();
      view.ask();
    },
    tiles(resolution, all) { world.tiles(resolution, all); view.ask(); },
    path(first, numbers) { world.path(first, numbers); view.ask(); },
    hypotheses(numbers) { world.hypotheses(numbers); view.ask(); },
    loops(numbers) { world.loops(numbers); view.ask(); },
    gone() { if (!offline) last_scan = performance.now(); offline = true; show_state(); setTimeout(show_state, 2100); view.ask(); },
  });
  show_theme();
  panel(innerWidth >= 1000);
  show_state();
  wire.connect();
  // For programs that operate this page.
  window.phasescan = { view, world, wire, get status() { return status; }, get first_picture_ms() { return first_picture; } };
})();
