"use strict";
// The line to the server: frames in, commands out, and again after it broke. docs/live.md has the frames.
const wire = (() => {
  const token = new URLSearchParams(location.search).get("token");
  const suffix = token ? "?token=" + encodeURIComponent(token) : "";
  const waiting = new Map();
  let socket = null, next = 1, pause = 500, heard = 0;
  const on = { hello() {}, status() {}, scan() {}, tiles() {}, path() {}, loops() {}, hypotheses() {}, gone() {} };
  const states = ["initialising", "ok", "degraded", "ambiguous", "lost"];

  function scan(view, buffer) {
    const f = (i) => view.getFloat32(16 + 4 * i, true), n = view.getUint32(4, true);
    on.scan({
      state: states[view.getUint8(1)] || "lost", placed: !(view.getUint16(2, true) & 1), stamp: view.getFloat64(8, true), x: f(0), y: f(1), theta: f(2),
      xx: f(3), xy: f(4), yy: f(5), tt: f(6), explained: f(7), latency: f(8), unit: f(9), points: new Int16Array(buffer, 56, 2 * n),
    });
  }

  function tiles(view, buffer) {
    const all = [];
    for (let at = 8; at + 12 <= buffer.byteLength;) {
      const size = view.getUint32(at + 8, true);
      all.push({ i: view.getInt32(at, true), k: view.getInt32(at + 4, true), packed: new Uint8Array(buffer, at + 12, size) });
      at += 12 + size;
    }
    on.tiles(view.getFloat32(4, true), all);
  }

  function text(message) {
    if (message.do === "hello") on.hello(message);
    if (message.do === "done") {
      const done = waiting.get(message.id);
      waiting.delete(message.id);
      if (done) done(message.ok, message.text);
    }
    if (message.do === undefined) on.status(message);
  }

  function take(data) {
    heard = performance.now();
    if (typeof data === "string") return text(JSON.parse(data));
    const view = new DataView(data), kind = view.getUint8(0);
    if (kind === 1) scan(view, data);
    if (kind === 2) tiles(view, data);
    if (kind === 3) on.path(view.getUint32(4, true), new Float32Array(data, 8));
    if (kind === 4) on.loops(new Int32Array(data, 4));
    if (kind === 5) on.hypotheses(new Float32Array(data, 4));
  }

  function connect() {
    socket = new WebSocket((location.protocol === "https:" ? "wss://" : "ws://") + location.host + "/ws" + suffix);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => { pause = 500; heard = performance.now(); };
    socket.onmessage = (event) => take(event.data);
    socket.onclose = () => {
      for (const done of waiting.values()) done(false, "the connection broke before there was an answer");
      waiting.clear();
      on.gone();
      setTimeout(connect, pause);
      pause = Math.min(5000, 1.6 * pause);
    };
  }
  // The status comes every second: a line that is silent is dead, whatever the system says of it.
  setInterval(() => { if (socket && socket.readyState === 1 && performance.now() - heard > 8000) socket.close(); }, 2000);

  return {
    on, connect, suffix,
    ask(what, more, done) {
      if (!socket || socket.readyState !== 1) return done(false, "there is no connection");
      const id = next++;
      waiting.set(id, done);
      socket.send(JSON.stringify({ id, do: what, ...more }));
    },
    break() { socket.close(); },
  };
})();
