// Writes the seed corpora: a few small inputs for each target, of every kind its format has (those of printed/ are
// texts that are kept by hand).
#include <cmath>
#include <filesystem>
#include <fstream>

#include "io/ros_encode.hpp"
#include "live/streams.hpp"
#include "localize/prepared_file.hpp"
#include "phasescan/localize/localizer.hpp"
#include "phasescan/slam/state.hpp"
#include "support/ros_fixture.hpp"
#include "support/sealed_state.hpp"
#include "support/toy_map.hpp"
#include "support/toy_world.hpp"

namespace {

using namespace phasescan::test;

std::vector<Message> messages(bool ros1) {
  const std::string slash = ros1 ? "/" : "/msg/";
  const std::int64_t start = 1'600'000'000'000'000'000;
  std::vector<Message> out;
  out.push_back({"/tf_static", "tf2_msgs" + slash + "TFMessage", start,
                 transforms(ros1, {{start, "base_link", "laser", 0.1, 0.2, {1, 0, 0, 0}}})});
  for (int k = 0; k < 3; ++k) {
    const std::int64_t t = start + k * 100'000'000;
    out.push_back({"/odom", "nav_msgs" + slash + "Odometry", t, odometry(ros1, t, 0.1 * k, 0, 0.1)});
    out.push_back({"/scan", "sensor_msgs" + slash + "LaserScan", t,
                   laser_scan(ros1, t, {1.0F, 0.0F, 2.0F, INFINITY, NAN, 3.0F})});
  }
  return out;
}

std::string repeat(const std::string& text, int n, const std::string& separator) {
  std::string out;
  for (int i = 0; i < n; ++i) out += (i ? separator : "") + text;
  return out;
}

void write(const std::string& folder, const std::string& name, const std::string& bytes) {
  std::filesystem::create_directories(folder);
  write_bytes(folder + "/" + name, bytes);
}

void write_recordings(const std::string& root) {
  for (const char* compression : {"none", "bz2", "lz4"}) {
    BagStyle style;
    style.compression = compression;
    write(root + "/rosbag1", compression, rosbag1(messages(true), style));
  }
  BagStyle old;
  old.index_of_2010 = true;
  write(root + "/rosbag1", "index-2010", rosbag1(messages(true), old));
  for (const char* compression : {"", "lz4", "zstd"}) {
    McapStyle style;
    style.compression = compression;
    write(root + "/mcap", std::string("chunks-") + (*compression ? compression : "none"), mcap(messages(false), style));
  }
  McapStyle flat;
  flat.chunked = false;
  write(root + "/mcap", "no-chunks", mcap(messages(false), flat));
  McapStyle ros1;
  ros1.encoding = "ros1";
  write(root + "/mcap", "ros1", mcap(messages(true), ros1));
  write(root + "/mcap", "packed", pack_zstd(mcap(messages(false), flat)));
  std::filesystem::create_directories(root + "/sqlite");
  rosbag2_sqlite(root + "/sqlite/plain", messages(false), false, 512);
  rosbag2_sqlite(root + "/sqlite/packed-messages", messages(false), true, 512);
}

void write_texts(const std::string& root) {
  write(root + "/carmen", "all",
        "# CARMEN Logfile\nPARAM robot_frontlaser_offset 0.1\nODOM 1 2 0.5 0 0 0 10.5 host 0.5\n"
        "FLASER 5 1.0 2.0 81.83 3.5 0.2 1 2 0.5 1.1 2.1 0.6 10.5 host 0.5\n"
        "RAWLASER1 0 -1.57 3.14 0.785 8.1 0.01 0 5 1 2 3 8.1 5 2 7 8 10.6 host 0.6\n"
        "ROBOTLASER1 0 -1.57 3.14 0.785 8.1 0.01 0 5 1 2 3 4 5 0 1 2 0.5 1 2 0.4 0 0 0.5 0.5 0 10.7 host 0.7\n"
        "ROBOTLASER1 0 -1.57 3.14 0.785 8.1 0.01 0 3 1 2 3 1 2 0.5 1 2 0.4 0 0 0.5 0.5 10 host 500000\n");
  const std::string scan =
      R"({"angle_min": -1, "angle_increment": 0.5, "range_min": 0.1, "range_max": 6, "ranges": [1, 0, null, 7.5, 2], "stamp": 1.25)";
  write(root + "/scan_log", "two", scan + "}\n" + scan + R"(, "odometry": {"x": 1, "y": 2, "theta": 0.5}})" + "\n");
  write(root + "/scan_log", "more",
        scan + R"(, "time_increment": 0.001, "intensities": [1,2,3,4,5], "angles": [0,1,2,3,4]})" + "\n");
  write(root + "/lowcost", "ticks", "1 2 3" + repeat(" 1500", 360, "") + "\n5 6 180" + repeat(" 0", 360, "") + "\n");
  write(root + "/lowcost", "breezy", repeat("1", 24, " ") + repeat(" 9", 682, "") + " 7\n");
  write(root + "/lowcost", "polar",
        "1.5, 2.5, 0.1, " + repeat("1.25", 70, ", ") + "\n0.5, 0, 0.1, " + repeat("0.0", 64, ", ") + "\n");
  write(root + "/csv", "echo",
        "%time,field.header.stamp,field.angle_min,field.angle_increment,field.range_max,field.ranges0,field.ranges1\n"
        "1600000000000000123,1600000000000000123,-1.0,0.5,10,1.0,inf\n1600000000000000200,1600000000000000200,-1.0,0.5,"
        "10,nan,2\n");
  write(root + "/csv", "beams",
        "#Angule\tDistance\tQuality\n0.5 1000 47\n90.5 2000 47\n180.5 0 0\n0.4 1000 47\n90.4 900 47\n");
  write(root + "/csv", "numbered",
        "scan;time_ms;angle_rad;range_m;odom_x;odom_y;odom_theta\n1;100;0.0;1;0.5;0.2;0.1\n1;100;0.1;2;0.5;0.2;0.1\n2;"
        "200;0;3;1;0;0\n");
  write(root + "/columns", "beams", "angle_deg_cw,range_mm,quality\n0.5 1000 47\n90.5 2000 47\n0.4 1000 47\n");
  write(root + "/columns", "ranges", "stamp,angle_min_deg,ranges\n1.5,-90,1,2,3\n1.6,-90,1,,3\n");
  write(root + "/metadata", "plain",
        "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: mcap\n  relative_file_paths:\n    - "
        "x_0.mcap\n");
  write(root + "/options", "match", "match:\n  method: fft-mh\n  min_confidence: 0.9\n");
  write(root + "/text", "relations", "1.5 2.5 0.1 0.2 0 0 0 0.3\n2.5 3.5 0.1 0.2 0 0 0 -0.3\n");
  write(root + "/text", "tum", "1.000000 1 2 0 0 0 0 1\n# comment\n2.5 1 2 0 0 0 0.7071 0.7071\n");
  write(root + "/text", "pair",
        "{\"id\": \"1\", \"reference\": " + scan + "}, \"scan\": " + scan +
            "}, \"truth\": {\"x\": 0, \"y\": 0, \"theta\": 0}}\n");
  write(root + "/crashes", "empty-line", "\n");
}

void write_messages(const std::string& root) {
  const std::int64_t t = 1'600'000'000'000'000'007;
  for (const bool ros1 : {true, false}) {
    const auto kind = [&](int type) { return std::string(1, static_cast<char>(2 * type + (ros1 ? 0 : 1))); };
    const std::string name = ros1 ? "ros1" : "cdr";
    write(root + "/ros_messages", "scan-" + name, kind(0) + laser_scan(ros1, t, {1.0F, 2.0F, 3.0F}));
    write(root + "/ros_messages", "odometry-" + name, kind(1) + odometry(ros1, t, 1, 2, 0.5));
    write(root + "/ros_messages", "transforms-" + name, kind(2) + transforms(ros1, {{t, "a", "b", 1, 2, {}}}));
  }
}

/// Two scans of a room, the second turned, in the form fuzz_match reads.
void write_match(const std::string& root) {
  const auto scan = [](double turn, bool full) {
    std::string out;
    for (const float value : {full ? -3.1415927F : -1.5F, full ? 0.0174533F : 0.03F, 0.1F, 12.0F}) {
      out.append(reinterpret_cast<const char*>(&value), 4);
    }
    const std::size_t beams = full ? 360 : 100;
    out += u16(beams) + '\1';
    for (std::size_t i = 0; i < beams; ++i) {
      const double angle = (full ? -M_PI : -1.5) + static_cast<double>(i) * (full ? 0.0174533 : 0.03) + turn;
      const double range =
          std::min(3.0 / std::max(1e-3, std::abs(std::cos(angle))), 2.0 / std::max(1e-3, std::abs(std::sin(angle))));
      out += u16(static_cast<std::size_t>(100 * std::min(range, 11.0)));
    }
    return out;
  };
  write(root + "/match", "room", scan(0.0, true) + scan(0.4, true));
  write(root + "/match", "half", scan(0.0, false) + scan(0.1, false));
  write(root + "/match", "zeros", std::string(64, '\0'));
}

}  // namespace

namespace {

/// Each form of each protocol: the model's number, the size of the pieces, and some packets.
void write_live(const std::string& root) {
  using namespace phasescan::live;
  std::filesystem::create_directories(root + "/live");
  for (const testing::Form& form : testing::forms()) {
    std::size_t number = 0;
    while (sensor_models()[number].name != form.sensor) ++number;
    std::string bytes = {static_cast<char>(number), 60};
    for (const std::uint8_t byte : testing::opening(form)) bytes += static_cast<char>(byte);
    int packets = 0;
    for (const WirePacket& packet : testing::packets_of(form, 3)) {
      if (packets++ >= 4 && bytes.size() > 1500) break;
      bytes.append(packet.bytes.begin(), packet.bytes.end());
    }
    std::ofstream(root + "/live/" + testing::name_of(form), std::ios::binary) << bytes;
  }
}

/// Prepared maps, packed and not; of cells that are merged as well. What they were made of is what fuzz_prepared says.
void write_prepared(const std::string& root) {
  using namespace phasescan;
  for (const double cell : {0.1, 0.02}) {
    const TrinaryMap drawn = testing::toy_map(testing::two_rooms(), {0, 0}, cell, 0.2);
    LocalizeOptions options;
    options.view_spacing_m = 0.7;
    const std::string bytes = encode_prepared({drawn, LocalizationMap::from_grid(drawn, options)}, {1, 2});
    const std::string name = cell > 0.05 ? "rooms" : "merged-cells";
    write(root + "/prepared", name + "-packed", bytes);
    if (cell > 0.05) write(root + "/prepared", name, testing::unpacked_file(bytes, kPreparedMap));
  }
}

/// Saved runs, not packed: of two drives, in bounded memory, two that were merged, and one that has hardly begun.
void write_states(const std::string& root) {
  using namespace phasescan;
  const auto walls = testing::two_rooms();
  const auto tour = testing::toy_tour(0.5, 0.5, 1.5);
  const auto save = [&](const std::string& name, const SlamState& state, const SlamOptions& options) {
    write(root + "/state", name, testing::unpacked_file(encode_state({state, options, {{"slam", "a note"}}})));
  };
  const auto drive = [&](Slam& slam, std::size_t from, std::size_t scans, double start_s) {
    Random random(from + 1);
    testing::ToyLidar lidar;
    lidar.beams = 36;
    for (std::size_t i = from; i < from + scans; ++i) {
      const Stamp stamp = stamp_from_seconds(start_s + 0.5 * static_cast<double>(i - from));
      RangeMeasurement measurement{testing::toy_scan(walls, tour[i], lidar, random, stamp)};
      measurement.T_odom_base = tour[i];
      slam.add(measurement);
    }
  };
  SlamOptions bounded;
  bounded.slam.bounded_memory = true;
  for (const bool small : {false, true}) {
    const SlamOptions options = small ? bounded : SlamOptions{};
    Slam slam(options);
    drive(slam, 0, 10, 1.0);
    slam.begin_session();
    drive(slam, 6, 6, 500.0);
    save(small ? "bounded" : "two-drives", slam.checkpoint(), options);
  }
  Slam one, other, begun;
  drive(one, 0, 8, 1.0);
  drive(other, 4, 8, 500.0);
  drive(begun, 0, 1, 1.0);
  save("merged", merge_states({one.checkpoint(), other.checkpoint()}, {}).state, {});
  save("begun", begun.checkpoint(), {});
}

std::string frame_of(bool binary, const std::string& bytes) {
  return std::string(1, binary ? '\1' : '\0') + static_cast<char>(bytes.size() & 255) +
         static_cast<char>(bytes.size() >> 8) + bytes;
}

/// What Foxglove and Lichtblick say when they connect, subscribe, and a person drags a pose.
void write_foxglove(const std::string& root) {
  using namespace phasescan;
  const std::string subscribe = R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":1},{"id":1,"channelId":4}]})";
  const auto advertise = [](const std::string& encoding) {
    return R"({"op":"advertise","channels":[{"id":1,"topic":"/initialpose","encoding":")" + encoding +
           R"(","schemaName":"geometry_msgs/msg/PoseWithCovarianceStamped"}]})";
  };
  ByteWriter cdr;
  ros::encode(ros::PoseEstimate{{1, "map"}, {1.0, 2.0, 0.5}, Eigen::Matrix3d::Identity()}, cdr);
  const std::string head("\1\1\0\0\0", 5);
  const std::string by_cdr = head + std::string(cdr.bytes().begin(), cdr.bytes().end());
  const std::string by_json = head + R"({"header":{"frame_id":"map"},"pose":{"pose":{"position":{"x":1,"y":2,"z":0},)"
                                     R"("orientation":{"x":0,"y":0,"z":0,"w":1}},"covariance":[0.25,0,0]}})";
  write(root + "/foxglove", "subscribe",
        frame_of(false, subscribe) + frame_of(false, R"({"op":"unsubscribe","subscriptionIds":[0]})"));
  write(root + "/foxglove", "pose_cdr", frame_of(false, advertise("cdr")) + frame_of(true, by_cdr));
  write(root + "/foxglove", "pose_json", frame_of(false, advertise("json")) + frame_of(true, by_json));
  write(root + "/foxglove", "others",
        frame_of(false, R"({"op":"getParameters","parameterNames":[]})") +
            frame_of(false, R"({"op":"unadvertise","channelIds":[1]})") + frame_of(true, "\2") +
            frame_of(false, R"({"op":"fetchAsset","uri":"package://a","requestId":1})"));
}

}  // namespace

int main(int argc, char** argv) {
  const std::string root = argc > 1 ? argv[1] : "fuzz/corpus";
  write_recordings(root);
  write_texts(root);
  write_messages(root);
  write_match(root);
  write_live(root);
  write_states(root);
  write_prepared(root);
  write_foxglove(root);
}
