// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/robust_stability.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "certify/contraction.hpp"
#include "margins/loop_parts.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/counted.hpp"
#include "quadtune/internal/enum_names.hpp"
#include "quadtune/internal/in_parallel.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using internal::Contraction;
using internal::Coordinates;
using internal::EnclosedBox;
using internal::LoopPart;

constexpr Index kMaxNumbers = 10;

// Number of boxes that the threads examine together. A constant, so that the result does not depend
// on the number of threads.
constexpr std::size_t kTogether = 16;

// A box whose relative width is smaller than this is not split.
constexpr double kNarrowest = 1e-9;

/// The evidence from all boxes of one part.
struct PartEvidence {
  double gap = std::numeric_limits<double>::infinity();
  double condition = 1;
  double share = 0;  ///< proved fraction of the box of the part
};

/// A box that is not proved yet, and the best coordinates of the box of which it is a half.
struct OpenBox {
  EnclosedBox box;
  std::shared_ptr<const Coordinates> start;
  double share = 1;  ///< fraction of the box of its part
};

std::string name_of(const LoopPart& part) {
  const std::string known = names(part.loop.plant.states);
  return known.empty() ? fmt::format("{} states", part.states.size()) : known;
}

/// Whether a box is wide enough along a coordinate to be split.
bool can_split(const EnclosedBox& box, Index along) {
  if (along < 0) return false;
  const bool number = along < box.low.size();
  const double low = number ? box.low(along) : box.ahead_low;
  const double high = number ? box.high(along) : box.ahead_high;
  return high - low > kNarrowest * std::max(std::abs(low), std::abs(high));
}

std::pair<EnclosedBox, EnclosedBox> halves(const EnclosedBox& box, Index along) {
  std::pair<EnclosedBox, EnclosedBox> two{box, box};
  if (along < box.low.size()) {
    const double middle = 0.5 * (box.low(along) + box.high(along));
    two.first.high(along) = two.second.low(along) = middle;
  } else {
    two.first.ahead_high = two.second.ahead_low = 0.5 * (box.ahead_low + box.ahead_high);
  }
  return two;
}

LoopBox in_delays(const EnclosedBox& box, double dt) {
  const double longest = box.past * dt;
  return {box.low, box.high, box.past == 0 ? 0 : std::max(0.0, longest - box.ahead_high),
          box.past == 0 ? 0 : longest - box.ahead_low};
}

/// One proof: the budget and the evidence of all parts.
class Proof {
 public:
  Proof(const UncertainLoop& loop, const StabilityProofOptions& options)
      : loop_(loop), options_(options), threads_(internal::thread_count(options.threads)) {}

  StabilityProof run(const LoopBox& box) {
    result_.status = StabilityProofStatus::proved;
    result_.gap = std::numeric_limits<double>::infinity();
    std::vector<EnclosedBox> regions = internal::same_states(box, loop_.law.dt);
    // Start with long delays, where proofs are most likely to fail.
    std::reverse(regions.begin(), regions.end());
    for (const EnclosedBox& region : regions) {
      std::vector<LoopPart> parts = internal::loop_parts(loop_, region);
      name_parts(parts);
      if (!region_is_proved(parts, region)) break;
    }
    return std::move(result_);
  }

 private:
  void name_parts(const std::vector<LoopPart>& parts) {
    result_.parts.clear();
    for (const LoopPart& part : parts) result_.parts.push_back(name_of(part));
  }

  bool region_is_proved(const std::vector<LoopPart>& parts, const EnclosedBox& region) {
    std::vector<PartEvidence> evidence(parts.size());
    double gap = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < parts.size(); ++i) {
      if (!part_is_proved(parts[i], region, evidence[i])) return false;
      gap = std::min(gap, evidence[i].gap);
    }
    const double coupled = coupling(parts, evidence, region);
    if (!(coupled < gap)) return merged_is_proved(parts, region, coupled, gap);
    result_.gap = std::min(result_.gap, gap - coupled);
    result_.coupling = std::max(result_.coupling, coupled);
    return true;
  }

  /// The coupling between the parts is too strong: proves the whole loop as one part.
  bool merged_is_proved(const std::vector<LoopPart>& parts, const EnclosedBox& region,
                        double coupled, double gap) {
    if (parts.size() > 1) {
      const std::vector<LoopPart> one = {internal::whole_loop(loop_)};
      name_parts(one);
      return region_is_proved(one, region);
    }
    return fail(
        StabilityProofStatus::not_proved, parts.front(), region,
        fmt::format("the coupling {:.2g} is not smaller than the gap {:.2g}", coupled, gap));
  }

  bool part_is_proved(const LoopPart& part, const EnclosedBox& region, PartEvidence& evidence) {
    if (std::ssize(part.terms) > kMaxNumbers)
      throw InvalidInput("prove_stability",
                         fmt::format("{} parameters affect {}, expected at most {}",
                                     part.terms.size(), name_of(part), kMaxNumbers));
    std::vector<OpenBox> open = {{part.share(region), nullptr}};
    const int before = result_.boxes;
    while (!open.empty()) {
      if (takes_too_long(result_.boxes - before, evidence.share))
        return fail(StabilityProofStatus::not_proved, part, open.back().box,
                    fmt::format("{} examined, and {:.2g} of the box is proved",
                                internal::counted(result_.boxes, "part of the box was",
                                                  "parts of the box were"),
                                evidence.share));
      const auto left = static_cast<std::size_t>(options_.max_boxes - result_.boxes);
      if (left == 0)
        return fail(
            StabilityProofStatus::not_proved, part, open.back().box,
            fmt::format("{} examined", internal::counted(result_.boxes, "part of the box was",
                                                         "parts of the box were")));
      std::vector<OpenBox> together;
      while (!open.empty() && together.size() < std::min(kTogether, left)) {
        together.push_back(std::move(open.back()));
        open.pop_back();
      }
      std::vector<Contraction> contractions(together.size());
      try {
        internal::in_parallel(
            together.size(), threads_,
            [&]() -> internal::PartWorker {
              return [&](std::size_t i) {
                contractions[i] = internal::prove_contraction(part.loop, together[i].box,
                                                              together[i].start.get());
              };
            },
            options_.interrupted);
      } catch (const Interrupted&) {
        return fail(StabilityProofStatus::interrupted, part, together.front().box, "interrupted");
      }
      for (std::size_t i = 0; i < together.size(); ++i)
        if (!goes_on(part, together[i], std::move(contractions[i]), evidence, open)) return false;
    }
    return true;
  }

  /// Whether the part would exceed the budget by the factor of the options.
  /// @param boxes  number of boxes of this part that were examined
  /// @param share  fraction of the part's box that they prove
  [[nodiscard]] bool takes_too_long(int boxes, double share) const {
    constexpr int kEnoughToTell = 128;
    return boxes >= kEnoughToTell && boxes > share * options_.abort_factor * options_.max_boxes;
  }

  /// Records the evidence of a proved box; splits a box that is not proved.
  /// @return  false if the proof ends here
  bool goes_on(const LoopPart& part, const OpenBox& one, Contraction contraction,
               PartEvidence& evidence, std::vector<OpenBox>& open) {
    const EnclosedBox& box = one.box;
    ++result_.boxes;
    if (contraction.proved) {
      ++result_.proved_boxes;
      evidence.share += one.share;
      evidence.gap = std::min(evidence.gap, contraction.gap);
      evidence.condition = std::max(evidence.condition, contraction.condition);
      return true;
    }
    if (!(contraction.radius < 1))
      return fail(StabilityProofStatus::unstable, part, box,
                  fmt::format("spectral radius {:.9g} at its midpoint", contraction.radius));
    if (!can_split(box, contraction.widest))
      return fail(StabilityProofStatus::not_proved, part, box,
                  fmt::format("spectral radius {:.12g} in a box that is too narrow to split",
                              contraction.radius));
    std::shared_ptr<const Coordinates> start;
    if (contraction.coordinates)
      start = std::make_shared<const Coordinates>(*std::move(contraction.coordinates));
    auto [first, second] = halves(box, contraction.widest);
    open.push_back({std::move(second), start, 0.5 * one.share});
    open.push_back({std::move(first), start, 0.5 * one.share});
    return true;
  }

  /// ‖[Y_a E_ab Y_b⁻¹]‖₂ over all pairs of parts, with each Y scaled to the norm 1; E_aa is the
  /// contribution of paths through other parts.
  [[nodiscard]] double coupling(const std::vector<LoopPart>& parts,
                                const std::vector<PartEvidence>& evidence,
                                const EnclosedBox& region) const {
    if (parts.size() < 2) return 0;
    const MatrixXd size = internal::loop_size(loop_, region);
    const MatrixXd detour =
        internal::detour_size(loop_, region, internal::part_numbers(loop_, parts));
    double squares = 0;
    for (std::size_t a = 0; a < parts.size(); ++a)
      for (std::size_t b = 0; b < parts.size(); ++b) {
        const MatrixXd between = (a == b ? detour : size)(parts[a].places(loop_, region.past),
                                                          parts[b].places(loop_, region.past));
        const double one = internal::norm_bound(between) * evidence[b].condition;
        squares += one * one;
      }
    return internal::bounded_above(std::sqrt(squares));
  }

  bool fail(StabilityProofStatus status, const LoopPart& part, const EnclosedBox& box,
            const std::string& why) {
    result_.status = status;
    result_.gap = std::numeric_limits<double>::quiet_NaN();
    result_.part = name_of(part);
    result_.where = in_delays(box, loop_.law.dt);
    for (const PlantTerm& term : part.loop.terms) result_.numbers.push_back(term.name);
    result_.culprit = fmt::format("{}: {}", result_.part, why);
    return false;
  }

  const UncertainLoop& loop_;
  const StabilityProofOptions& options_;
  std::size_t threads_;
  StabilityProof result_;
};

}  // namespace

constexpr internal::EnumName<StabilityProofStatus> kStabilityProofStatuses[] = {
    {StabilityProofStatus::not_run, "not run"},
    {StabilityProofStatus::proved, "proved"},
    {StabilityProofStatus::unstable, "unstable"},
    {StabilityProofStatus::not_proved, "not proved"},
    {StabilityProofStatus::interrupted, "interrupted"}};

std::string to_string(StabilityProofStatus status) {
  return internal::name_in(kStabilityProofStatuses, status);
}

StabilityProof prove_stability(const UncertainLoop& loop, const LoopBox& box,
                               const StabilityProofOptions& options) {
  validate(loop, "prove_stability");
  validate(box, loop, "prove_stability");
  if (options.max_boxes < 1)
    throw InvalidInput("prove_stability",
                       fmt::format("max_boxes is {}, expected 1 or more", options.max_boxes));
  return Proof(loop, options).run(box);
}

}  // namespace quadtune
