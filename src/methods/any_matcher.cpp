#include "methods/any_matcher.hpp"

#include <stdexcept>
#include <variant>

#include "fft_icp/rotation_proposers.hpp"
#include "match/global_matcher.hpp"
#include "phasescan/core/pose2.hpp"
#include "phasescan/fft_icp/fft_icp.hpp"

namespace phasescan {
namespace {

using Engine = std::variant<GlobalMatcher, FftIcpMatcher>;

std::unique_ptr<RotationProposer> make_proposer(const AnyMatchOptions& options) {
  switch (options.match.rotations) {
    case RotationsFrom::kSpectrum:
      return propose_from_spectrum(options.global.rotation_peaks);
    case RotationsFrom::kMissing:
      return propose_from_missing(0.5 * deg_to_rad(options.global.sweep_step_deg));
    case RotationsFrom::kOwn:
      break;
  }
  return nullptr;
}

Engine make_engine(const AnyMatchOptions& options) {
  options.validate();
  const auto fft_icp = [&](FftIcpMethod method) {
    return Engine(std::in_place_type<FftIcpMatcher>, options.for_fft_icp(method));
  };
  switch (options.match.method) {
    case MatchMethod::kIcp:
      return fft_icp(FftIcpMethod::kIcp);
    case MatchMethod::kNdt:
      return fft_icp(FftIcpMethod::kNdt);
    case MatchMethod::kFft:
      return fft_icp(FftIcpMethod::kFft);
    case MatchMethod::kFftIcp1:
      return fft_icp(FftIcpMethod::kFftIcp1);
    case MatchMethod::kFftIcp2:
      return fft_icp(FftIcpMethod::kFftIcp2);
    case MatchMethod::kGlobal:
      return Engine(std::in_place_type<GlobalMatcher>, options.for_global(), make_proposer(options));
  }
  throw std::invalid_argument("match.method: not a method");
}

}  // namespace

struct AnyReference::Data {
  std::variant<Reference, FftIcpReference> prepared;
};

struct AnyMatcher::Impl {
  explicit Impl(const AnyMatchOptions& o) : options(o), engine(make_engine(o)) {}
  AnyMatchOptions options;
  Engine engine;
};

AnyMatcher::AnyMatcher(const AnyMatchOptions& options) : impl_(std::make_unique<Impl>(options)) {}
AnyMatcher::~AnyMatcher() = default;
AnyMatcher::AnyMatcher(AnyMatcher&&) noexcept = default;
AnyMatcher& AnyMatcher::operator=(AnyMatcher&&) noexcept = default;

MatchResult AnyMatcher::match(const Scan& reference, const Scan& scan, const MatchHints& hints) {
  return std::visit([&](auto& engine) { return engine.match(reference, scan, hints); }, impl_->engine);
}

AnyReference AnyMatcher::prepare(const Scan& reference, const Twist2& twist) {
  return std::visit(
      [&](auto& engine) {
        return AnyReference(
            std::make_shared<const AnyReference::Data>(AnyReference::Data{engine.prepare(reference, twist)}));
      },
      impl_->engine);
}

MatchResult AnyMatcher::match(const AnyReference& reference, const Scan& scan, const MatchHints& hints) {
  const auto& prepared = reference.data().prepared;
  if (prepared.index() != impl_->engine.index())
    throw std::invalid_argument("reference: prepared for another method than this matcher runs");
  if (GlobalMatcher* global = std::get_if<GlobalMatcher>(&impl_->engine))
    return global->match(std::get<Reference>(prepared), scan, hints);
  return std::get<FftIcpMatcher>(impl_->engine).match(std::get<FftIcpReference>(prepared), scan, hints);
}

const AnyMatchOptions& AnyMatcher::options() const {
  return impl_->options;
}

MatchResult match_any(const Scan& reference, const Scan& scan, const AnyMatchOptions& options,
                      const MatchHints& hints) {
  return AnyMatcher(options).match(reference, scan, hints);
}

}  // namespace phasescan
