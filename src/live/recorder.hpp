// A live run as an MCAP file while it goes on.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "io/mcap_file.hpp"
#include "live/bounded_queue.hpp"
#include "live/map_drawer.hpp"
#include "live/ros_view.hpp"
#include "phasescan/live/live.hpp"

namespace phasescan::live {

struct RecorderCounts {
  std::uint64_t scans = 0;    ///< in the file
  std::uint64_t dropped = 0;  ///< that came faster than the disk took them
  std::uint64_t bytes = 0;
  bool failed = false;  ///< the disk said no: nothing is recorded any more
};

/// Writes in a thread of its own: what the disk does never makes a scan late. The file is there from the first moment
/// and never lacks more than the last second, also where the process is killed; its index comes with `close`.
class Recorder {
 public:
  /// Where there is such a file already, NAME-2, NAME-3, ... is taken. @param tell  takes a line for people, from any
  /// thread. @throws as GrowingFile
  Recorder(const std::string& path, std::function<void(const std::string&)> tell);
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Never waits.
  void add(const LiveUpdate& live);
  /// All that was added is in the file, with its index. False where the disk said no.
  bool close();

  const std::string& path() const { return path_; }
  RecorderCounts counts() const;

 private:
  struct Item {
    std::optional<LiveUpdate> live;
    std::optional<RosMessage> map;
  };
  void work();
  bool write(const Item& item);  ///< true: a scan; a map waits for the next one
  void guarded(const std::function<void()>& writing);

  std::string path_;
  std::function<void(const std::string&)> tell_;
  McapFile file_;
  RosView view_;
  std::int64_t path_due_ns_ = 0;
  BoundedQueue<Item> queue_;
  std::atomic<std::uint64_t> scans_ = 0, bytes_ = 0;
  std::atomic<bool> failed_ = false, closed_ = false;
  std::thread thread_;
  std::optional<MapDrawer> drawer_;
};

}  // namespace phasescan::live
