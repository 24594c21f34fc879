// What is drawn, in metres: tiles of the map as pictures, the way, loops, the last scan.
const world = (() => {
  const kTile = 64, kChunk = 8, kSide = kTile * kChunk;
  const palettes = {
    light: { free: [255, 255, 255], wall: [24, 30, 38], unknown: [223, 228, 234] },
    dark: { free: [38, 45, 53], wall: [233, 238, 243], unknown: [13, 16, 20] },
  };
  const state = { resolution: 0.05, chunks: new Map(), tiles: new Map(), path: [], loops: [], hypotheses: [], born: new Map(), tail: [], scan: null, bounds: null };
  let colours = null;

  /// RGBA of each of the 16 levels: 0 unknown, 1..4 free, 5..9 between, 10..15 occupied.
  function choose(theme) {
    const p = palettes[theme], mix = (a, b, t) => a.map((v, i) => Math.round(v + (b[i] - v) * t));
    colours = new Uint8ClampedArray(64);
    for (let level = 1; level < 16; ++level) {
      let rgb = p.free;
      if (level >= 10) rgb = mix(p.free, p.wall, 0.72 + 0.28 * (level - 10) / 5);
      else if (level >= 5) rgb = mix(p.unknown, p.free, 0.45);
      else if (level > 2) rgb = mix(p.free, p.unknown, 0.12 * (level - 2));
      colours.set([...rgb, 255], 4 * level);
    }
    for (const tile of state.tiles.values()) paint(tile);
  }

  function chunk_of(i, k) {
    const ci = Math.floor(i / kChunk), ck = Math.floor(k / kChunk), key = ci + "," + ck;
    let chunk = state.chunks.get(key);
    if (!chunk) {
      const canvas = document.createElement("canvas");
      canvas.width = canvas.height = kSide;
      chunk = { ci, ck, canvas, context: canvas.getContext("2d") };
      state.chunks.set(key, chunk);
    }
    return chunk;
  }

  function paint(tile) {
    const image = new ImageData(kTile, kTile), out = image.data;
    let at = 0;
    for (const byte of tile.packed) {
      const colour = 4 * (byte >> 4);
      for (let run = (byte & 15) + 1; run > 0 && at < kTile * kTile; --run, ++at) {
        const to = 4 * ((kTile - 1 - (at >> 6)) * kTile + (at & 63));  // pictures begin at the top
        out[to] = colours[colour];
        out[to + 1] = colours[colour + 1];
        out[to + 2] = colours[colour + 2];
        out[to + 3] = colours[colour + 3];
      }
    }
    const chunk = chunk_of(tile.i, tile.k);
    chunk.context.putImageData(image, (tile.i - kChunk * chunk.ci) * kTile, (kChunk - 1 - (tile.k - kChunk * chunk.ck)) * kTile);
  }

  function find_bounds() {
    let bounds = null;
    const size = kTile * state.resolution;
    for (const tile of state.tiles.values()) {
      if (!tile.packed.length) continue;
      const b = tile.bounds, x0 = tile.i * size + b[0] * state.resolution, y0 = tile.k * size + b[1] * state.resolution;
      const x1 = tile.i * size + b[2] * state.resolution, y1 = tile.k * size + b[3] * state.resolution;
      bounds = bounds ? [Math.min(bounds[0], x0), Math.min(bounds[1], y0), Math.max(bounds[2], x1), Math.max(bounds[3], y1)] : [x0, y0, x1, y1];
    }
    state.bounds = bounds;
  }

  /// The smallest rectangle of its known cells.
  function bounds_of(packed) {
    let at = 0, i0 = kTile, k0 = kTile, i1 = 0, k1 = 0;
    for (const byte of packed) {
      const run = (byte & 15) + 1;
      if (byte >> 4) {
        for (let n = at; n < at + run; ++n) {
          const i = n & 63, k = n >> 6;
          if (i < i0) i0 = i;
          if (i + 1 > i1) i1 = i + 1;
          if (k < k0) k0 = k;
          if (k + 1 > k1) k1 = k + 1;
        }
      }
      at += run;
    }
    return [i0, k0, i1, k1];
  }

  /// Whether the pose is one of several, of which none is to go by.
  function is_guess(scan) {
    return scan.state === "ambiguous" && state.hypotheses.length > 1;
  }

  return {
    state, kSide, choose, is_guess,
    clear() {
      state.chunks.clear();
      state.tiles.clear();
      Object.assign(state, { path: [], loops: [], hypotheses: [], tail: [], scan: null, bounds: null });
      state.born.clear();
    },
    tiles(resolution, all) {
      state.resolution = resolution;
      for (const tile of all) {
        tile.packed = tile.packed.slice();
        tile.bounds = bounds_of(tile.packed);
        state.tiles.set(tile.i + "," + tile.k, tile);
        paint(tile);
      }
      find_bounds();
    },
    path(first, numbers) {
      state.path.length = Math.min(state.path.length, first);
      for (let i = 0; i + 1 < numbers.length; i += 2) state.path.push([numbers[i], numbers[i + 1]]);
      state.tail = state.tail.slice(-1);
    },
    /// A loop that is new shines for a while.
    loops(numbers) {
      const now = performance.now(), born = new Map();
      state.loops = [];
      for (let i = 0; i + 1 < numbers.length; i += 2) {
        const key = numbers[i] + "," + numbers[i + 1];
        born.set(key, state.born.get(key) ?? now);
        state.loops.push({ from: numbers[i], to: numbers[i + 1], born: born.get(key) });
      }
      state.born = born;
    },
    /// Places where the robot may be, the best first.
    hypotheses(numbers) {
      state.hypotheses = [];
      for (let i = 0; i + 3 < numbers.length; i += 4) state.hypotheses.push({ x: numbers[i], y: numbers[i + 1], theta: numbers[i + 2], confidence: numbers[i + 3] });
    },
    scan(scan) {
      state.scan = scan;
      if (!scan.placed || is_guess(scan)) state.tail = [];
      else if (scan.state !== "lost") state.tail.push([scan.x, scan.y]);
      if (state.tail.length > 600) state.tail.shift();
    },
  };
})();
