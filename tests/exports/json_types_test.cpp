// SPDX-License-Identifier: Apache-2.0
/// Our JSON files with a value of another type than we write.
#include <gmock/gmock.h>

#include <functional>
#include <nlohmann/json.hpp>

#include "plants/export_models.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/export.hpp"
#include "quadtune/exports/manifest.hpp"
#include "quadtune/exports/schedule_table.hpp"

namespace quadtune {
namespace {

using Json = nlohmann::ordered_json;
using Pointer = Json::json_pointer;
using Reader = std::function<void(const std::string&)>;

void add_places(const Json& json, const Pointer& here, std::vector<Pointer>& places) {
  places.push_back(here);
  if (json.is_object())
    for (const auto& [key, value] : json.items()) add_places(value, here / key, places);
  if (json.is_array() && !json.empty()) add_places(json[0], here / std::size_t{0}, places);
}

std::string manifest_of(ExportKind kind, const ExportContent& content) {
  return export_files(kind, content).back().bytes;
}

void read_manifest_text(const std::string& text) { (void)parse_manifest(text, "manifest.json"); }

std::string schedule() {
  GainSchedule schedule = empty_schedule({{ScheduleQuantity::speed, {0}}}, {{"x", "m"}},
                                         {{"w1", "rad/s"}}, {{"x", "m s"}});
  schedule.vehicle = schedule.convention = "uquad";
  schedule.status[0] = PointStatus::solved;
  for (Eigen::MatrixXd* M : {&schedule.K, &schedule.K_int, &schedule.x0, &schedule.u0})
    M->setOnes();
  schedule.residual(0) = 0;
  return schedule_text(schedule, TableFormat::json);
}

/// Whether `read` rejects `text`; only InvalidInput may be thrown.
bool refused(const std::string& text, const Reader& read) {
  try {
    read(text);
    return false;
  } catch (const InvalidInput&) {
    return true;
  }
}

TEST(JsonTypes, ReadersRefuseOthersThanTheyWrite) {
  const std::vector<std::pair<std::string, Reader>> files = {
      {manifest_of(ExportKind::uquad, testing::uquad_content()), read_manifest_text},
      {manifest_of(ExportKind::mambo, testing::mambo_content()), read_manifest_text},
      {manifest_of(ExportKind::json, testing::mambo_content()), read_manifest_text},
      {schedule(), [](const std::string& text) {
         (void)parse_schedule(text, "schedule.json", TableFormat::json);
       }}};
  for (const auto& [text, read] : files) {
    const Json right = Json::parse(text);
    ASSERT_FALSE(refused(right.dump(), read));
    std::vector<Pointer> places;
    add_places(right, Pointer(), places);
    ASSERT_GT(places.size(), 30U);
    for (const Pointer& place : places)
      for (const Json& other : {Json(nullptr), Json(true), Json(1), Json(-1e300), Json("text"),
                                Json::array({"text"}), Json::object({{"text", 1}})}) {
        Json wrong = right;
        const std::string name = place.to_string();
        const auto may_be = [&](const Json& value) {  // null: no limit
          return value.is_number() || (value.is_null() && name.find("/cascade/") == 0 &&
                                       name.find("_limit") != std::string::npos);
        };
        const bool same =
            other.type() == right.at(place).type() || (may_be(other) && may_be(right.at(place)));
        // Members for human readers, which are not read.
        bool read_back = true;
        for (const char* note : {"/about", "/description", "/loops/0/output", "/loops/0/unit"})
          read_back = read_back && name.find(note) == std::string::npos;
        wrong[place] = other;
        const bool is_refused = refused(wrong.dump(), read);
        EXPECT_TRUE(is_refused || same || !read_back) << name << " = " << other;
      }
  }
}

}  // namespace
}  // namespace quadtune
