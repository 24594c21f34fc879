// A plugged-in sensor as an iterator of poses.
#include "phasescan/live/live.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <thread>

#include "bind.hpp"
#include "live_sources.hpp"
#include "slam.hpp"

namespace phasescan::python {
namespace {

constexpr std::size_t kMostWaiting = 256;  // updates that the caller has not taken; the oldest then go

/// Sensor, SLAM and what they told, until it is closed.
class PyLive {
 public:
  PyLive(std::unique_ptr<live::LiveSource> source, MappingOptions options)
      : source_(std::move(source)),
        slam_(std::move(options), Schedule::kLatest, true),
        map_(slam_.slam.map()),
        thread_([this] { work(); }) {}
  ~PyLive() { close(); }
  PyLive(const PyLive&) = delete;
  PyLive& operator=(const PyLive&) = delete;

  /// The next update; nothing where none came within `timeout`. Ends with nothing and `ended`.
  std::optional<live::LiveUpdate> take(std::chrono::milliseconds timeout, bool& ended) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, timeout, [&] { return !updates_.empty() || ended_; });
    ended = updates_.empty() && ended_;
    if (updates_.empty()) return std::nullopt;
    live::LiveUpdate update = std::move(updates_.front());
    updates_.pop_front();
    return update;
  }
  /// What went wrong in the sensor's thread, once.
  std::exception_ptr failure() {
    const std::lock_guard lock(mutex_);
    return std::exchange(failure_, nullptr);
  }
  void close() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }
  std::vector<std::string> messages() {
    const std::lock_guard lock(mutex_);
    return {messages_.begin(), messages_.end()};
  }
  /// As of the newest scan that was handed on: SLAM itself belongs to its thread.
  TrinaryMap map() {
    std::shared_ptr<const MapSnapshot> map;
    {
      const std::lock_guard lock(mutex_);
      map = map_;
    }
    return map->draw();
  }
  bool ended() {
    const std::lock_guard lock(mutex_);
    return ended_;
  }

 private:
  void work() {
    try {
      live::run_live(
          *source_, slam_.slam, [this] { return stop_.load(); },
          [this](const live::LiveUpdate& update) { put(update); }, [this](const std::string& text) { tell(text); });
    } catch (...) {
      const std::lock_guard lock(mutex_);
      failure_ = std::current_exception();
    }
    const std::lock_guard lock(mutex_);
    ended_ = true;
    changed_.notify_all();
  }
  void put(const live::LiveUpdate& update) {
    const std::lock_guard lock(mutex_);
    if (updates_.size() == kMostWaiting) updates_.pop_front();
    updates_.push_back(update);
    if (update.map) map_ = update.map;
    changed_.notify_all();
  }
  void tell(const std::string& text) {
    const std::lock_guard lock(mutex_);
    if (messages_.size() == kMostWaiting) messages_.pop_front();
    messages_.push_back(text);
  }

  std::unique_ptr<live::LiveSource> source_;
  PySlam slam_;
  std::atomic<bool> stop_{false};
  std::mutex mutex_;
  std::condition_variable changed_;
  std::shared_ptr<const MapSnapshot> map_;
  std::deque<live::LiveUpdate> updates_;
  std::deque<std::string> messages_;
  std::exception_ptr failure_;
  bool ended_ = false;
  std::thread thread_;  // last: it uses all of the above
};

live::LiveUpdate next_update(PyLive& self) {
  while (true) {
    std::optional<live::LiveUpdate> update;
    bool ended = false;
    {
      const py::gil_scoped_release release;
      update = self.take(std::chrono::milliseconds(100), ended);
    }
    if (update) return std::move(*update);
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (!ended) continue;
    if (const std::exception_ptr failure = self.failure()) std::rethrow_exception(failure);
    throw py::stop_iteration();
  }
}

std::unique_ptr<PyLive> open_live(const std::string& port, const std::string& sensor, const std::string& raw, bool demo,
                                  const std::string& replay, std::uint64_t seed, const py::object& options,
                                  const py::kwargs& keywords) {
  MappingOptions asked = options_from<MappingOptions>(options, keywords);
  if (demo && !replay.empty()) throw std::invalid_argument("demo: expected one of demo and replay");
  const py::gil_scoped_release release;
  std::unique_ptr<live::LiveSource> source;
  if (demo) {
    source = app::demo_source(seed);
  } else if (!replay.empty()) {
    source = app::replay_source(replay, {});
  } else {
    source = live::open_sensor(port, sensor, raw);
  }
  return std::make_unique<PyLive>(std::move(source), std::move(asked));
}

void bind_live_update(py::module_& module) {
  using live::LiveUpdate;
  py::class_<LiveUpdate> type(module, "LiveUpdate", "What one scan of a plugged-in sensor brought, and how late.");
  type.def_property_readonly(
      "update", [](const LiveUpdate& u) { return u.update; }, "ScanUpdate.");
  type.def_property_readonly(
      "pose", [](const LiveUpdate& u) { return u.update.T_map_base(); }, "Pose2: T_map_base [m, rad].");
  type.def_property_readonly(
      "status", [](const LiveUpdate& u) { return std::string(to_string(u.update.status)); },
      "str: initialising, ok, degraded, ambiguous or lost.");
  type.def_property_readonly(
      "stamp", [](const LiveUpdate& u) { return stamp_to_seconds(u.update.stamp); }, "float: [s].");
  type.def_property_readonly(
      "covariance",
      [](const LiveUpdate& u) { return matrix_array(u.update.map_covariance.value_or(u.update.odom_covariance)); },
      "ndarray, shape (3, 3): [m^2, m rad, rad^2].");
  type.def_property_readonly(
      "confidence", [](const LiveUpdate& u) { return u.confidence; },
      "float: Share of hits that the map explains, 0..1.");
  type.def_property_readonly(
      "latency_ms", [](const LiveUpdate& u) { return u.latency_ms; }, "float: From the scan's last byte to this [ms].");
  type.def_property_readonly(
      "dropped", [](const LiveUpdate& u) { return u.dropped; }, "int: Scans left out so far.");
  type.def("__repr__", [](const LiveUpdate& u) {
    return fmt::format("<LiveUpdate {} at {}, {:.1f} ms late>", to_string(u.update.status),
                       pose_text(u.update.T_map_base()), u.latency_ms);
  });
}

constexpr const char* kLiveDoc =
    R"(live(port='auto', *, sensor='', raw='', demo=False, replay='', seed=1, options=None, **keywords)
--

Poses of a plugged-in sensor as they come, its map growing beside.

Parameters
----------
port : str
    auto, a device, tcp:HOST:PORT, udp:HOST:PORT, or a file of bytes that `raw` kept.
sensor : str
    Which one it is; else it is found by asking and listening.
raw : str
    A file that keeps the bytes as they come.
demo : bool
    A simulated sensor in a simulated flat, of `seed`.
replay : str
    A log of any readable format, at its pace.
options, **options
    As for `Slam`.

Returns
-------
Live
    Iterates over LiveUpdate; unplugged, it waits. `close` it, or use it in a with statement.

Raises
------
SystemError
    Nothing found, no permission, a port in use: one line that says what to do.)";

}  // namespace

void bind_live(py::module_& module) {
  bind_live_update(module);
  py::class_<PyLive> type(module, "Live", "A plugged-in sensor: an iterator of LiveUpdate.");
  type.def("__iter__", [](const py::object& self) { return self; });
  type.def("__next__", &next_update);
  type.def("__enter__", [](const py::object& self) { return self; });
  type.def("__exit__", [](PyLive& self, const py::args&) {
    const py::gil_scoped_release release;
    self.close();
  });
  type.def("close", &PyLive::close, py::call_guard<py::gil_scoped_release>(),
           "Lets the sensor go; what came before may still be taken.");
  type.def("map", &PyLive::map, py::call_guard<py::gil_scoped_release>(), "TrinaryMap: As far as it has grown.");
  type.def_property_readonly("messages", &PyLive::messages, "list of str: What the sensor's side told, the last ones.");
  type.def("__repr__", [](PyLive& self) { return std::string("<Live, ") + (self.ended() ? "ended>" : "running>"); });
  module.def("live", &open_live, py::arg("port") = "auto", py::kw_only(), py::arg("sensor") = "", py::arg("raw") = "",
             py::arg("demo") = false, py::arg("replay") = "", py::arg("seed") = 1, py::arg("options") = py::none(),
             kLiveDoc);
}

}  // namespace phasescan::python
