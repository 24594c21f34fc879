// phasescan eval --trajectory T (--reference R | --relations F | --closure LOG): how good a trajectory is.
#include <fmt/format.h>

#include <cmath>

#include "command_list.hpp"
#include "commands.hpp"
#include "eval/closure.hpp"
#include "eval/relations.hpp"
#include "eval/trajectory_error.hpp"
#include "phasescan/io/error.hpp"
#include "io/tum.hpp"

namespace phasescan::app {
namespace {

constexpr const char* kNoPose = "not one pose; expected lines of stamp x y z qx qy qz qw";

struct EvalFlags {
  std::string trajectory, reference, relations, closure, laser, topic;
  double max_gap_s = 0.01, delta = 1.0;
  std::string delta_unit = "f";
  bool no_align = false, json = false;
};

std::string stats_json(const ErrorStats& s, double scale = 1.0) {
  // Of nothing there is no mean: a zero would read as perfect.
  if (s.n == 0) return R"({"n": 0, "rmse": null, "mean": null, "median": null, "std": null, "min": null, "max": null})";
  return fmt::format(
      R"({{"n": {}, "rmse": {:.6f}, "mean": {:.6f}, "median": {:.6f}, "std": {:.6f}, "min": {:.6f}, "max": {:.6f}}})",
      s.n, scale * s.rmse, scale * s.mean, scale * s.median, scale * s.std, scale * s.min, scale * s.max);
}

std::string stats_line(const char* name, const char* unit, const ErrorStats& s, double scale = 1.0) {
  if (s.n == 0) return fmt::format("{:<14} none (n = 0)\n", name);
  return fmt::format("{:<14} rmse {:.4f} mean {:.4f} median {:.4f} std {:.4f} max {:.4f} {} (n = {})\n", name,
                     scale * s.rmse, scale * s.mean, scale * s.median, scale * s.std, scale * s.max, unit, s.n);
}

/// Mean and standard deviation of the squares, as [Kuemmerle09] reports them.
ErrorStats squared(const std::vector<double>& errors, double scale) {
  std::vector<double> squares;
  squares.reserve(errors.size());
  for (const double e : errors) squares.push_back(scale * e * scale * e);
  return error_stats(squares);
}

int eval_reference(const EvalFlags& flags, const std::vector<StampedPose>& trajectory) {
  const std::vector<StampedPose> reference = read_tum(flags.reference);
  if (reference.empty()) throw InputError(flags.reference, 0, kNoPose);
  const AssociatedPoses pairs = associate(trajectory, reference, flags.max_gap_s);
  if (pairs.estimate.empty()) {
    throw InputError(
        flags.reference, 0,
        fmt::format("no pose within {} s of one of the trajectory; expected the same clock in both", flags.max_gap_s));
  }
  const StepUnit unit = flags.delta_unit == "m" ? StepUnit::kMetres : StepUnit::kFrames;
  const ErrorStats ate = error_stats(absolute_trajectory_errors(pairs, !flags.no_align));
  const ErrorStats turned = error_stats(absolute_rotation_errors(pairs, !flags.no_align));
  const RelativeErrors rpe = relative_pose_errors(pairs, flags.delta, unit);
  const ErrorStats translation = error_stats(rpe.translation), rotation = error_stats(rpe.rotation);
  const double deg = rad_to_deg(1.0);
  if (flags.json) {
    print(fmt::format(
        "{{\"poses\": {}, \"reference_poses\": {}, \"pairs\": {}, \"aligned\": {}, \"ate_m\": {}, \"translation_m\": {}, \"rotation_deg\": {}, \"rpe_delta\": {}, \"rpe_delta_unit\": \"{}\", "
        "\"rpe_m\": {}, \"rpe_deg\": {}}}\n",
        trajectory.size(), reference.size(), pairs.estimate.size(), !flags.no_align, stats_json(ate), stats_json(ate),
        stats_json(turned, deg), flags.delta, flags.delta_unit, stats_json(translation), stats_json(rotation, deg)));
  } else {
    print(fmt::format("{} of {} poses paired with {} of the reference\n", pairs.estimate.size(), trajectory.size(),
                      reference.size()) +
          stats_line("ATE", "m", ate) + stats_line("ATE rotation", "deg", turned, deg) +
          stats_line("RPE", "m", translation) + stats_line("RPE rotation", "deg", rotation, deg));
  }
  return kDone;
}

int eval_relations(const EvalFlags& flags, const std::vector<StampedPose>& trajectory) {
  Pose2 T_base_laser;
  if (!flags.laser.empty()) {
    const std::vector<double> v = parse_numbers("--laser", flags.laser, 3);
    T_base_laser = {v[0], v[1], wrap_angle(deg_to_rad(v[2]))};
  }
  const std::vector<Relation> relations = read_relations(flags.relations);
  if (relations.empty())
    throw InputError(flags.relations, 0, "not one relation; expected lines of time_a time_b x y z roll pitch yaw");
  const RelationErrors errors = relation_errors(trajectory, relations, T_base_laser, flags.max_gap_s);
  const double deg = rad_to_deg(1.0);
  const ErrorStats t = error_stats(errors.translation), r = error_stats(errors.rotation);
  const ErrorStats t2 = squared(errors.translation, 1.0), r2 = squared(errors.rotation, deg);
  std::size_t above = 0;
  for (const double e : errors.translation) above += e > 0.2;
  if (flags.json) {
    print(fmt::format(
        "{{\"relations\": {}, \"answered\": {}, \"unanswered\": {}, \"translation_m\": {}, \"rotation_deg\": {}, "
        "\"translation_squared_m2\": {}, \"rotation_squared_deg2\": {}, \"above_0.2_m\": {}}}\n",
        errors.relations, errors.translation.size(), errors.unanswered, stats_json(t), stats_json(r, deg),
        stats_json(t2), stats_json(r2), above));
  } else if (errors.translation.empty()) {
    print(fmt::format("{} relations, none answered\n", errors.relations));
  } else {
    print(
        fmt::format("{} relations, {} answered, {} unanswered\n", errors.relations, errors.translation.size(),
                    errors.unanswered) +
        fmt::format(
            "translation    mean {:.4f} +- {:.4f} m, squared {:.6f} +- {:.6f} m2, median {:.4f}, max {:.3f}, {} above 0.2 m\n",
            t.mean, t.std, t2.mean, t2.std, t.median, t.max, above) +
        fmt::format(
            "rotation       mean {:.3f} +- {:.3f} deg, squared {:.4f} +- {:.4f} deg2, median {:.3f}, max {:.2f}\n",
            deg * r.mean, deg * r.std, r2.mean, r2.std, deg * r.median, deg * r.max));
  }
  return errors.translation.empty() ? kAnswerIsNo : kDone;
}

int eval_closure(const EvalFlags& flags, const std::vector<StampedPose>& trajectory) {
  LogOptions options;
  options.topic = flags.topic;
  const auto log = open_log(flags.closure, options);
  const Closure closure = closure_errors(*log, trajectory);
  std::vector<double> metres, degrees;
  for (const Return& r : closure.returns) {
    metres.push_back(r.translation_m);
    degrees.push_back(rad_to_deg(r.rotation_rad));
  }
  const ErrorStats t = error_stats(metres), r = error_stats(degrees);
  const std::string end = metres.empty() ? "null" : fmt::format("{:.4f}", metres.back());
  const std::string last = metres.empty() ? "null" : std::to_string(closure.returns.back().second);
  if (flags.json) {
    print(fmt::format(
        "{{\"returns\": {}, \"matched\": {}, \"translation_m\": {}, \"rotation_deg\": {}, \"last_return_scan\": {}, "
        "\"last_return_m\": {}}}\n",
        closure.looked_at, metres.size(), stats_json(t), stats_json(r), last, end));
  } else {
    print(fmt::format("{} returns, {} matched\n", closure.looked_at, metres.size()) + stats_line("closure", "m", t) +
          stats_line("rotation", "deg", r) +
          (metres.empty() ? "" : fmt::format("last return at scan {}: {} m\n", last, end)));
  }
  const int code = report_damages(*log, kDone);
  return metres.empty() ? kAnswerIsNo : code;
}

}  // namespace

void add_eval_command(CLI::App& app, CommandBody& body) {
  auto* command =
      app.add_subcommand("eval", "how good a trajectory is: ATE and RPE, the relations metric, or how well it closes");
  auto flags = std::make_shared<EvalFlags>();
  command->add_option("--trajectory", flags->trajectory, "the trajectory, TUM format")->required()->type_name("T.tum");
  auto* reference =
      command->add_option("--reference", flags->reference, "reference trajectory, TUM format: ATE and RPE")
          ->type_name("R.tum");
  auto* relations =
      command->add_option("--relations", flags->relations, "verified relative poses: the relations metric")
          ->type_name("F.relations");
  reference->excludes(relations);
  auto* closure =
      command
          ->add_option(
              "--closure", flags->closure,
              "the trajectory's log: scans of one place long apart are matched and compared with the trajectory")
          ->type_name("LOG")
          ->excludes(reference)
          ->excludes(relations);
  command
      ->add_option(
          "--laser", flags->laser,
          "--relations: where the laser sits on the base, if the trajectory is the base's and the relations are the laser's")
      ->type_name("X,Y,DEG")
      ->needs(relations);
  command->add_option("--topic", flags->topic, "--closure, ROS logs: only this scan topic")->needs(closure);
  command->add_option("--max-gap", flags->max_gap_s, "stamps farther apart do not belong together [s]")
      ->check(number_from_zero())
      ->capture_default_str();
  command->add_option("--delta", flags->delta, "--reference: step of the RPE")
      ->check(number_above_zero())
      ->capture_default_str()
      ->needs(reference);
  command->add_option("--delta-unit", flags->delta_unit, "--reference: f: frames, m: metres")
      ->check(one_of({"f", "m"}))
      ->capture_default_str()
      ->needs(reference);
  command->add_flag("--no-align", flags->no_align, "--reference: compare as they are")->needs(reference);
  command->add_flag("--json", flags->json, "one JSON object");
  command->footer("Example:\n  phasescan eval --trajectory map/trajectory.tum --reference drive.jsonl.truth.tum");
  command->callback([flags, &body] {
    body = [flags] {
      if (flags->reference.empty() && flags->relations.empty() && flags->closure.empty())
        throw std::invalid_argument(
            "eval: neither --reference nor --relations nor --closure is given; expected one of them");
      if (flags->delta_unit == "f" && flags->delta != std::floor(flags->delta))
        throw std::invalid_argument(
            fmt::format("--delta: {} frames; expected a whole number, or --delta-unit m", flags->delta));
      const std::vector<StampedPose> trajectory = read_tum(flags->trajectory);
      if (trajectory.empty()) throw InputError(flags->trajectory, 0, kNoPose);
      if (!flags->closure.empty()) return eval_closure(*flags, trajectory);
      return flags->relations.empty() ? eval_reference(*flags, trajectory) : eval_relations(*flags, trajectory);
    };
  });
}

}  // namespace phasescan::app
