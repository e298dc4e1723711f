// SPDX-License-Identifier: Apache-2.0
/// Which filter models a log can feed, and which signals are missing for the others.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "quadtune/estimation/filter_model.hpp"
#include "quadtune/logs/log_survey.hpp"

namespace quadtune {

/// The signals that a filter model of any kind uses.
struct ModelSignals {
  /// One sensor of the model.
  struct Sensor {
    std::string name;             ///< e.g. "sonar"
    std::vector<Signal> outputs;  ///< measured together in one sample
  };
  std::string name;             ///< e.g. "altitude"
  std::vector<Signal> inputs;   ///< all of them are required
  std::vector<Sensor> sensors;  ///< at least one of them is required
  /// z points up in the model's world, so that y and z of a quadtune flight log change sign.
  bool z_up = false;
};

/// The signals of a model.
[[nodiscard]] ModelSignals signals_of(const FilterModel& model);

/// Signals of each built-in model, in the order of the documentation.
[[nodiscard]] std::vector<ModelSignals> signals_of_built_in_models();

/// An input or output that the log does not provide by name.
struct MissingSignal {
  Signal signal;       ///< name and unit in the model
  std::string sensor;  ///< sensor that measures it; empty for an input
  std::string why;     ///< what is wrong with the channel of the same name; empty if there is none
  /// Full names of channels with a matching unit that the user may mean, those with similar names
  /// first.
  std::vector<std::string> candidates;
};

/// What a log provides for one model, and what it lacks.
struct ModelNeeds {
  std::string model;   ///< name of the model
  bool feeds = false;  ///< all inputs and all outputs of at least one sensor are available
  std::vector<std::pair<std::string, std::string>> uses;  ///< signal, and the channel that feeds it
  std::vector<MissingSignal> missing;  ///< if the model is fed: outputs of its other sensors
  bool own_log = false;  ///< flight log of quadtune: without --map, missing signals are omitted
};

/// Computes which signals of a model a log provides. A channel feeds the signal of the same name,
/// with or without the name of its group, as read_log_channels() resolves names, if it has samples
/// and strictly increasing times and if its unit is that of the signal or either unit is empty.
[[nodiscard]] ModelNeeds model_needs(const ModelSignals& model, const LogSurvey& log);

/// One line: "altitude: fed by az, height", or the missing signals and how to map them.
[[nodiscard]] std::string to_text(const ModelNeeds& needs);

}  // namespace quadtune
