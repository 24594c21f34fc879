// A pose estimate as applications publish it: PoseWithCovarianceStamped as CDR or as JSON.
#include <cmath>
#include <nlohmann/json.hpp>

#include "foxglove/client.hpp"
#include "io/file.hpp"
#include "io/ros_tf.hpp"

namespace phasescan::foxglove {
namespace {

using nlohmann::json;

constexpr const char* kFrame = "map";
constexpr std::size_t kMostBytes = 16384;

double number_at(const json& message, const std::string& path) {
  const json::json_pointer pointer(path);
  if (!message.contains(pointer) || !message[pointer].is_number())
    throw ProtocolError("/initialpose: no number at " + path);
  return message[pointer].get<double>();
}

ros::PoseEstimate from_json(std::string_view text) {
  const json message = json::parse(text, nullptr, false);
  if (message.is_discarded() || !message.is_object()) throw ProtocolError("/initialpose: is no JSON object");
  ros::PoseEstimate out;
  const json::json_pointer frame("/header/frame_id");
  if (message.contains(frame) && message[frame].is_string()) out.header.frame_id = message[frame].get<std::string>();
  ros::Pose3 pose;
  pose.translation = {number_at(message, "/pose/pose/position/x"), number_at(message, "/pose/pose/position/y"), 0.0};
  const std::string turn = "/pose/pose/orientation/";
  pose.rotation = Eigen::Quaterniond(number_at(message, turn + "w"), number_at(message, turn + "x"),
                                     number_at(message, turn + "y"), number_at(message, turn + "z"));
  out.pose = ros::planar(pose);
  const json::json_pointer covariance("/pose/covariance");
  if (message.contains(covariance)) {
    const json& list = message[covariance];
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) {
        const std::size_t at = static_cast<std::size_t>(ros::kPlanar[row] * 6 + ros::kPlanar[column]);
        const json* value = list.is_array() && at < list.size() ? &list[at] : nullptr;
        if (value != nullptr && value->is_number()) out.covariance(row, column) = value->get<double>();
      }
    }
  }
  return out;
}

}  // namespace

ros::PoseEstimate parse_pose(std::string_view encoding, std::span<const std::uint8_t> payload) {
  if (payload.size() > kMostBytes) throw ProtocolError("/initialpose: more than 16 KiB");
  ros::PoseEstimate out;
  if (encoding == "json") {
    out = from_json({reinterpret_cast<const char*>(payload.data()), payload.size()});
  } else {
    try {
      ros::decode(ros::Wire::kCdr, payload, out);
    } catch (const DecodeError& error) {
      throw ProtocolError(std::string("/initialpose: ") + error.what());
    }
  }
  if (!out.pose.is_finite() || !out.covariance.allFinite())
    throw ProtocolError("/initialpose: a number that is not finite");
  if (out.header.frame_id != kFrame)
    throw ProtocolError("/initialpose: is in the frame " + quote_text(out.header.frame_id) +
                        "; expected 'map' (3D panel: Frame, Display frame)");
  return out;
}

}  // namespace phasescan::foxglove
