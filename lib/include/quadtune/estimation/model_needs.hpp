// SPDX-License-Identifier: Apache-2.0
/// Which filter models a log can feed, and what it lacks for the others.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "quadtune/estimation/filter_model.hpp"
#include "quadtune/logs/log_survey.hpp"

namespace quadtune {

/// What a filter takes from a log, whatever kind of model it is.
struct ModelSignals {
  struct Sensor {
    std::string name;             ///< e.g. "sonar"
    std::vector<Signal> outputs;  ///< that it measures in one sample
  };
  std::string name;             ///< e.g. "altitude"
  std::vector<Signal> inputs;   ///< all of them are needed
  std::vector<Sensor> sensors;  ///< one of them is enough
  /// Its world has z up, so that y and z of a flight log of quadtune come with the other sign.
  bool z_up = false;
};

[[nodiscard]] ModelSignals signals_of(const FilterModel& model);

/// Of each built-in model, in the order of the documentation.
[[nodiscard]] std::vector<ModelSignals> signals_of_built_in_models();

/// An input or output that a log cannot feed by itself.
struct MissingSignal {
  Signal signal;
  std::string sensor;  ///< that measures it; "" for an input
  std::string why;     ///< what is wrong with the channel of its name; "" where there is none
  /// Channels of its unit that a user may mean, by their full names, those of like names first.
  std::vector<std::string> candidates;
};

struct ModelNeeds {
  std::string model;
  bool feeds = false;  ///< all inputs are there, and all outputs of one sensor
  std::vector<std::pair<std::string, std::string>> uses;  ///< signal, and the channel that feeds it
  std::vector<MissingSignal> missing;  ///< of a model that is fed: of its other sensors
  bool own_log = false;  ///< a flight log of quadtune: without --map, what is missing is left out
};

/// A channel feeds the signal of its name, in full or without its group's, as read_log_channels()
/// takes names, where it has samples and times that increase, and its unit is the signal's or one
/// of them has none.
[[nodiscard]] ModelNeeds needs_of_model(const ModelSignals& model, const LogSurvey& log);

/// One line: "altitude: fed by az, height", or what is missing and how to name it.
[[nodiscard]] std::string to_text(const ModelNeeds& needs);

}  // namespace quadtune
