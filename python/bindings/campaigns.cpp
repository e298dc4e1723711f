// SPDX-License-Identifier: Apache-2.0
/// Campaigns: many flights with drawn parameters, and their records as arrays.
#include <filesystem>

#include "flights.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/workbench/campaign/campaign_folder.hpp"
#include "quadtune/workbench/campaign/campaign_merge.hpp"
#include "quadtune/workbench/campaign/campaign_plan.hpp"
#include "quadtune/workbench/campaign/campaign_run.hpp"
#include "report/flights/flights.hpp"
#include "support/interrupts.hpp"
#include "support/topics.hpp"

namespace quadtune::python {
namespace {

namespace py = pybind11;
using namespace py::literals;
namespace fs = std::filesystem;

struct CampaignResult {
  std::string folder;
  CampaignPlan plan;
  MergedCampaign merged;
  std::vector<std::string> files;

  [[nodiscard]] internal::Json statistics_json() const {
    return report::to_json(plan, merged.statistics, folder);
  }
};

/// Writes the tables, statistics.json, report.html and the logs that are kept.
CampaignResult merge(const std::string& folder, std::size_t threads, const Stop& stop) {
  CampaignResult result;
  result.folder = folder;
  result.plan = load_plan(folder);
  const CampaignPlan& plan = result.plan;
  result.merged = merge_campaign(plan, folder, threads, stop);
  const MergedCampaign& merged = result.merged;
  result.files = write_campaign_tables(plan, merged, folder, threads, stop);
  const auto write = [&](const std::string& file, const std::string& bytes) {
    save(file, bytes);
    result.files.push_back(file);
  };
  write((fs::path(folder) / "statistics.json").string(), json_of(result.statistics_json()) + "\n");
  write((fs::path(folder) / "report.html").string(),
        report::campaign_html(plan, merged.statistics, merged.records, folder));
  for (const std::uint64_t number : kept_flights(plan, merged.records)) {
    const FileContent log = campaign_log(plan, folder, number, stop);
    write(log.name, log.bytes);
  }
  return result;
}

CampaignResult run(const Path& file, const std::optional<Path>& given_folder, std::uint32_t shards,
                   std::size_t threads, const std::optional<std::uint64_t>& seed) {
  const std::string folder =
      given_folder ? given_folder->text : fs::path(file.text).stem().string() + "-campaign";
  return long_call([&](const Stop& stop) {
    (void)write_campaign(make_campaign(file.text, shards, seed), folder, stop);
    const CampaignPlan plan = load_plan(folder);
    CampaignWatch watch;
    watch.stop = stop;
    fly_campaign(plan, folder, threads, watch);
    return merge(folder, threads, stop);
  });
}

template <class Value, class Of>
py::array_t<Value> array_of(const std::vector<CampaignRecord>& records, Of of) {
  py::array_t<Value> array(static_cast<py::ssize_t>(records.size()));
  auto values = array.template mutable_unchecked<1>();
  for (std::size_t i = 0; i < records.size(); ++i)
    values(static_cast<py::ssize_t>(i)) = of(records[i]);
  return array;
}

/// A metric of all flights by its name.
/// @throws KeyError
py::array_t<double> metric_array(const CampaignResult& result, const std::string& name) {
  const std::optional<Metric> metric = metric_of(name);
  if (!metric) throw py::key_error("no metric '" + name + "'; metrics lists them");
  return array_of<double>(result.merged.records,
                          [&](const CampaignRecord& record) { return record.metrics[*metric]; });
}

Flight replay(const CampaignResult& result, std::uint64_t number, bool log) {
  if (number >= result.plan.campaign.records())
    throw OptionError("number", "number is " + std::to_string(number) + ", expected less than " +
                                    std::to_string(result.plan.campaign.records()));
  return long_call([&](const Stop& stop) -> Flight {
    PlannedFlight plan = replayed_flight(result.plan, number);
    if (log) keep_log(plan);
    return {fly_planned(std::move(plan), stop), {}};
  });
}

}  // namespace

void add_campaigns(py::module_& module) {
  py::class_<CampaignResult> type(module, "Campaign", "Many flights with drawn parameters.");
  const auto records = [](const CampaignResult& result) -> const std::vector<CampaignRecord>& {
    return result.merged.records;
  };
  type.def_property_readonly(
          "name", [](const CampaignResult& result) { return result.plan.name; }, "Its name.")
      .def_readonly("folder", &CampaignResult::folder, "Where plan, flights and tables are.")
      .def_readonly("files", &CampaignResult::files, "What was written.")
      .def(
          "__len__", [=](const CampaignResult& result) { return records(result).size(); },
          "Number of flights.")
      .def_property_readonly(
          "designs",
          [](const CampaignResult& result) {
            std::vector<std::string> names;
            for (const CampaignCase& one : result.plan.campaign.cases) names.push_back(one.design);
            return names;
          },
          "Name of the design of each case; flight n is of case n % len(designs).")
      .def_property_readonly(
          "missions",
          [](const CampaignResult& result) {
            std::vector<std::string> names;
            for (const CampaignCase& one : result.plan.campaign.cases) names.push_back(one.mission);
            return names;
          },
          "Name of the mission of each case.")
      .def_property_readonly(
          "passed",
          [=](const CampaignResult& result) {
            return array_of<bool>(records(result),
                                  [](const CampaignRecord& record) { return record.passed; });
          },
          "Whether each flight passed.")
      .def_property_readonly(
          "end_time",
          [=](const CampaignResult& result) {
            return array_of<double>(records(result),
                                    [](const CampaignRecord& record) { return record.end_time; });
          },
          "How long each flight was flown [s].")
      .def_property_readonly(
          "metrics", [](const CampaignResult&) { return metric_names(); }, "Names of the metrics.")
      .def("__getitem__", &metric_array, "metric"_a,
           "A metric of every flight as an array; NaN where a flight does not have it.")
      .def_property_readonly(
          "quantities",
          [](const CampaignResult& result) {
            std::vector<std::string> names;
            for (const UncertainNumber& number : result.plan.campaign.uncertainty.numbers)
              names.push_back(number.quantity);
            return names;
          },
          "Names of what is drawn.")
      .def_property_readonly(
          "drawn",
          [](const CampaignResult& result) -> const Eigen::MatrixXd& {
            return result.merged.drawn;
          },
          py::return_value_policy::reference_internal, "What was drawn for each flight.")
      .def("replay", &replay, "number"_a, "log"_a = true, "Fly one flight of the campaign again.");
  add_report(
      type, "quadtune campaign merge DIR",
      [](const CampaignResult& result) {
        internal::Json json = result.statistics_json();
        json["files"] = result.files;
        return json;
      },
      [](const CampaignResult& result) {
        return report::to_text(result.plan, result.merged.statistics, result.folder);
      });
  module.def(
      "campaign", &run, "file"_a, "folder"_a = py::none(), py::kw_only(), "shards"_a = 0,
      "threads"_a = 0, "seed"_a = py::none(),
      "Plan, fly and merge a campaign on this machine.\n\n"
      "file: a campaign file (docs/formats.md). folder: a new one, or one where this was\n"
      "stopped, which continues there; default: the file's name with -campaign, in the current\n"
      "folder. shards: parts into which the flights are divided; 0 chooses. threads: 0 for one\n"
      "of each processor. seed: replaces that of the file. Ctrl-C ends it; what was flown stays.\n"
      "Raises InvalidInput with \"file:line\" for a wrong file, NoSolution if a design of it has\n"
      "none, FileError if files cannot be read or written.");
  module.def(
      "load_campaign",
      [](const Path& folder, std::size_t threads) {
        return long_call([&](const Stop& stop) { return merge(folder.text, threads, stop); });
      },
      "folder"_a, py::kw_only(), "threads"_a = 0,
      "Merge the flown shards of a campaign, as `quadtune campaign merge` does.\n\n"
      "folder: where the campaign was planned. threads: 0 for one of each processor. Raises\n"
      "InvalidInput if shards are missing or do not belong together, FileError if files cannot\n"
      "be read or written.");
}

}  // namespace quadtune::python
