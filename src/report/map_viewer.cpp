#include "report/map_viewer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "output/map_file.hpp"
#include "report/slam_report.hpp"

namespace phasescan {
namespace {

constexpr std::size_t kMostWay = 2000;  // poses of the way that is drawn

constexpr const char* kPage = R"html(<style>
#viewer { border: 1px solid #9aa0a6; touch-action: none; width: 100%; height: min(70vh, 36rem); display: block; cursor: grab; background: #cdcdcd; }
.viewer-row { display: flex; gap: .5rem; align-items: center; margin: .4rem 0; } .viewer-row input { flex: 1; min-width: 6rem; }
.viewer-row button { min-width: 2.6rem; min-height: 2.4rem; font-size: 1.05rem; }
#viewer-text { font-size: .9rem; font-variant-numeric: tabular-nums; min-height: 2.8em; }
</style>
<canvas id="viewer"></canvas>
<div class="viewer-row"><button id="viewer-in" title="nearer">+</button><button id="viewer-out" title="farther">&#8722;</button><button id="viewer-fit">fit</button>
<input id="viewer-time" type="range" min="0" value="0" aria-label="time"/></div>
<div id="viewer-text"></div>
)html";

constexpr const char* kScript = R"js(
(() => {
const canvas = document.getElementById('viewer'), c = canvas.getContext('2d'), slider = document.getElementById('viewer-time');
const bytes = Uint8Array.from(atob(run.points), ch => ch.charCodeAt(0)), points = new DataView(bytes.buffer);
const starts = [0]; for (const s of run.scans) starts.push(starts[starts.length - 1] + s.n);
const image = new Image();
let view = {x: 0, y: 0, s: 50}, ratio = 1;
slider.max = Math.max(0, run.scans.length - 1);
const px = (x, y) => [(x - view.x) * view.s + canvas.width / 2, (view.y - y) * view.s + canvas.height / 2];
function fit() {
  view = {x: run.x + run.w / 2, y: run.y + run.h / 2, s: Math.min(canvas.width / run.w, canvas.height / run.h)};
  draw();
}
function size() {
  ratio = window.devicePixelRatio || 1;
  canvas.width = canvas.clientWidth * ratio; canvas.height = canvas.clientHeight * ratio;
  fit();
}
function line(list, color, width) {
  c.strokeStyle = color; c.lineWidth = width * ratio; c.beginPath();
  for (let i = 0; i < list.length; i += 2) { const p = px(list[i] / 100, list[i + 1] / 100); i ? c.lineTo(...p) : c.moveTo(...p); }
  c.stroke();
}
function scale() {
  const most = canvas.width / 4 / view.s, ten = 10 ** Math.floor(Math.log10(most));
  const m = [5, 2, 1].map(k => k * ten).find(k => k <= most), x = 14 * ratio, y = canvas.height - 14 * ratio;
  c.fillStyle = 'rgba(255,255,255,.8)'; c.fillRect(x - 6 * ratio, y - 24 * ratio, m * view.s + 12 * ratio, 30 * ratio);
  c.fillStyle = '#1a1a1a'; c.fillRect(x, y - 3 * ratio, m * view.s, 3 * ratio);
  c.font = 13 * ratio + 'px sans-serif'; c.fillText(m + ' m', x, y - 8 * ratio);
}
function scan() {
  const k = +slider.value, s = run.scans[k]; if (!s) return;
  const co = Math.cos(s.a), si = Math.sin(s.a);
  c.fillStyle = '#d55e00';
  for (let i = starts[k]; i < starts[k + 1]; ++i) {
    const x = points.getInt16(4 * i, true) / 100, y = points.getInt16(4 * i + 2, true) / 100;
    const p = px(s.x + co * x - si * y, s.y + si * x + co * y);
    c.fillRect(p[0] - 1.5 * ratio, p[1] - 1.5 * ratio, 3 * ratio, 3 * ratio);
  }
  const p = px(s.x, s.y), r = 9 * ratio;
  c.fillStyle = '#0072b2'; c.beginPath();
  for (const [d, l] of [[0, 1.4], [2.5, 1], [-2.5, 1]]) c.lineTo(p[0] + l * r * Math.cos(s.a + d), p[1] - l * r * Math.sin(s.a + d));
  c.fill();
  let sure = 'covariance not kept';
  if (s.c) {
    const [xx, xy, yy, tt] = s.c, mean = (xx + yy) / 2, off = Math.hypot((xx - yy) / 2, xy);
    const big = Math.sqrt(mean + off), small = Math.sqrt(Math.max(0, mean - off));
    c.strokeStyle = '#b2679c'; c.lineWidth = 2 * ratio; c.beginPath();
    c.ellipse(p[0], p[1], 3 * big * view.s, 3 * small * view.s, -0.5 * Math.atan2(2 * xy, xx - yy), 0, 2 * Math.PI); c.stroke();
    sure = '1 sigma ' + (100 * big).toFixed(1) + ' cm, ' + (Math.sqrt(tt) * 180 / Math.PI).toFixed(2) + ' deg';
  }
  document.getElementById('viewer-text').textContent = 'Scan ' + s.i + ' at ' + s.t.toFixed(1) + ' s: ' + s.s + ', x ' + s.x.toFixed(2) +
    ' m, y ' + s.y.toFixed(2) + ' m, ' + (s.a * 180 / Math.PI).toFixed(1) + ' deg; ' + sure;
}
function draw() {
  c.fillStyle = '#cdcdcd'; c.fillRect(0, 0, canvas.width, canvas.height); c.imageSmoothingEnabled = false;
  const p = px(run.x, run.y + run.h);
  if (image.complete && image.naturalWidth) c.drawImage(image, p[0], p[1], run.w * view.s, run.h * view.s);
  line(run.way, '#0072b2', 1.2); scan(); scale();
}
function zoom(by, x, y) {
  const mx = view.x + (x - canvas.width / 2) / view.s, my = view.y - (y - canvas.height / 2) / view.s;
  view.s = Math.min(5000, Math.max(0.5, view.s * by));
  view.x = mx - (x - canvas.width / 2) / view.s; view.y = my + (y - canvas.height / 2) / view.s; draw();
}
const held = new Map();
canvas.onpointerdown = e => { canvas.setPointerCapture(e.pointerId); held.set(e.pointerId, e); };
canvas.onpointerup = canvas.onpointercancel = e => held.delete(e.pointerId);
canvas.onpointermove = e => {
  const before = held.get(e.pointerId); if (!before) return;
  const other = [...held.values()].find(o => o.pointerId !== e.pointerId);
  view.x -= (e.clientX - before.clientX) * ratio / view.s / held.size; view.y += (e.clientY - before.clientY) * ratio / view.s / held.size;
  held.set(e.pointerId, e);
  const gap = o => Math.hypot(o.clientX - other.clientX, o.clientY - other.clientY);
  if (other && gap(before) > 0) {
    const box = canvas.getBoundingClientRect();
    zoom(gap(e) / gap(before), ((e.clientX + other.clientX) / 2 - box.left) * ratio, ((e.clientY + other.clientY) / 2 - box.top) * ratio);
  }
  draw();
};
canvas.onwheel = e => { e.preventDefault(); zoom(Math.exp(-e.deltaY / 400), e.offsetX * ratio, e.offsetY * ratio); };
document.getElementById('viewer-in').onclick = () => zoom(1.5, canvas.width / 2, canvas.height / 2);
document.getElementById('viewer-out').onclick = () => zoom(1 / 1.5, canvas.width / 2, canvas.height / 2);
document.getElementById('viewer-fit').onclick = fit;
slider.oninput = draw; window.onresize = size; image.onload = draw;
image.src = 'data:image/png;base64,' + run.map; size();
})();
)js";

void append_scan(std::string& text, std::string& bytes, const ShownScan& shown, const SlamResult& result) {
  const ScanResult& scan = result.scans[shown.scan];
  const Pose2& p = scan.T_map_base;
  text += fmt::format("{}{{\"i\":{},\"t\":{:.3f},\"s\":\"{}\",\"x\":{:.3f},\"y\":{:.3f},\"a\":{:.4f},\"n\":{}",
                      text.empty() ? "" : ",\n", shown.scan, stamp_to_seconds(scan.stamp - result.scans.front().stamp),
                      to_string(scan.status), p.x, p.y, p.theta, shown.points_cm.size() / 2);
  if (scan.covariance) {
    const auto& c = *scan.covariance;
    text += fmt::format(",\"c\":[{:.3g},{:.3g},{:.3g},{:.3g}]", c(0, 0), c(0, 1), c(1, 1), c(2, 2));
  }
  text += "}";
  for (const std::int16_t v : shown.points_cm) {
    const auto bits = static_cast<std::uint16_t>(v);
    bytes += static_cast<char>(bits & 0xFF);
    bytes += static_cast<char>(bits >> 8);
  }
}

}  // namespace

void ShownScans::add(std::size_t index, const Scan& upright, const Pose2& T_base_laser) {
  if (index % every_ != 0) return;
  if (scans_.size() >= kMost) {
    thin_out();
    if (index % every_ != 0) return;
  }
  ShownScan shown{index, {}};
  const std::size_t step = std::max<std::size_t>(1, (upright.hit_count() + kMostPoints - 1) / kMostPoints);
  std::size_t hit = 0;
  for (std::size_t i = 0; i < upright.size(); ++i) {
    if (!upright.is_hit(i) || hit++ % step != 0) continue;
    const double range = static_cast<double>(upright.ranges[i]), angle = upright.angle(i) + T_base_laser.theta;
    for (const double m : {T_base_laser.x + range * std::cos(angle), T_base_laser.y + range * std::sin(angle)})
      shown.points_cm.push_back(static_cast<std::int16_t>(std::lround(std::clamp(100.0 * m, -32767.0, 32767.0))));
  }
  scans_.push_back(std::move(shown));
}

void ShownScans::thin_out() {
  every_ *= 2;
  std::vector<ShownScan> kept;
  for (std::size_t i = 0; i < scans_.size(); i += 2) kept.push_back(std::move(scans_[i]));
  scans_ = std::move(kept);
}

void ShownScans::append(const ShownScans& other, std::size_t first) {
  while (every_ < other.every_) thin_out();
  for (std::size_t i = 0; i < other.scans_.size(); i += every_ / other.every_) {
    scans_.push_back(other.scans_[i]);
    scans_.back().scan += first;
  }
  while (scans_.size() > kMost) thin_out();
}

std::string map_viewer(const SlamResult& result, const ShownScans& shown) {
  std::string scans, bytes, way;
  for (const ShownScan& scan : shown.scans()) {
    if (scan.scan < result.scans.size()) append_scan(scans, bytes, scan, result);
  }
  const std::size_t stride = std::max<std::size_t>(1, (result.scans.size() + kMostWay - 1) / kMostWay);
  for (std::size_t i = 0; i < result.scans.size(); i += stride) {
    const Pose2& p = result.scans[i].T_map_base;
    way += fmt::format("{}{},{}", way.empty() ? "" : ",", std::lround(100.0 * p.x), std::lround(100.0 * p.y));
  }
  const TrinaryMap& map = result.map;
  std::string page = kPage;
  page += fmt::format(
      "<script>const run = {{\"x\":{:.3f},\"y\":{:.3f},\"w\":{:.3f},\"h\":{:.3f},\"way\":[{}],\n\"scans\":[{}],\n\"points\":\"{}\",\n\"map\":\"{}\"}};\n",
      map.origin.x, map.origin.y, std::max(1e-3, map.width * map.resolution_m),
      std::max(1e-3, map.height * map.resolution_m), way, scans, base64(bytes), base64(format_png(map)));
  page += std::string(kScript) + "</script>\n";
  std::string caption =
      "Drag to move, wheel or two fingers to zoom; the slider goes through the run. Orange: the scan, purple: 3 sigma of its position.";
  if (shown.every() > 1) caption += fmt::format(" Every {}th scan is kept here.", shown.every());
  return page + "<p class=\"caption\">" + caption + "</p>\n";
}

}  // namespace phasescan
