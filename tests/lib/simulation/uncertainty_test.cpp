// SPDX-License-Identifier: Apache-2.0
#include "quadtune/simulation/campaign/uncertainty.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <fstream>
#include <iterator>

#include "golden.hpp"
#include "matrix_near.hpp"
#include "plants/designed_mambo.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/uncertainty_reader.hpp"
#include "source_folder.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using ::testing::HasSubstr;
using testing::MatrixNear;
using ::testing::StrEq;
using ::testing::ThrowsMessage;

constexpr std::uint32_t kDraws = 20000;

/// (kDraws × n)
MatrixXd draws(const Uncertainty& uncertainty, std::uint64_t seed = 3) {
  MatrixXd all(kDraws, static_cast<Eigen::Index>(uncertainty.numbers.size()));
  for (std::uint32_t i = 0; i < kDraws; ++i) all.row(i) = draw(uncertainty, seed, i).transpose();
  return all;
}

double deviation(const VectorXd& x) {
  return std::sqrt((x.array() - x.mean()).square().sum() / static_cast<double>(x.size() - 1));
}

Uncertainty read(const std::string& text, const std::filesystem::path& folder = {}) {
  return internal::read_uncertainty(internal::TomlTable::parse(text, "f.toml"), folder);
}

// Means and deviations in closed form; 4 standard errors of 20,000 draws.
TEST(Uncertainty, DrawsHaveTheMomentsOfTheirDistributions) {
  const Uncertainty uncertainty{{{"mass", {DistributionKind::normal, 1, 0.05}},
                                 {"thrust", {DistributionKind::uniform, 0.8, 1.2}},
                                 {"drag", {DistributionKind::log_normal, 1, 0.2}}},
                                {}};
  validate(uncertainty, "test");
  const MatrixXd all = draws(uncertainty);
  const double root = std::sqrt(double{kDraws});
  EXPECT_NEAR(all.col(0).mean(), 1, 4 * 0.05 / root);
  EXPECT_NEAR(deviation(all.col(0)), 0.05, 4 * 0.05 / root);
  EXPECT_NEAR(all.col(1).mean(), 1, 4 * 0.1155 / root);
  EXPECT_NEAR(deviation(all.col(1)), 0.4 / std::sqrt(12), 4 * 0.1 / root);
  EXPECT_GE(all.col(1).minCoeff(), 0.8);
  EXPECT_LE(all.col(1).maxCoeff(), 1.2);
  EXPECT_NEAR(all.col(2).array().log().mean(), 0, 4 * 0.2 / root);
  EXPECT_NEAR(deviation(all.col(2).array().log()), 0.2, 4 * 0.2 / root);
}

// A normal distribution cut at both sides: its quantiles are those of the cut one, also far out.
TEST(Uncertainty, LimitsScaleTheRestUp) {
  const boost::math::normal normal;
  for (const double shift : {0.0, 3.0, -3.0, 7.5, -7.5}) {
    const Distribution cut{DistributionKind::normal, 0, 1, shift - 0.5, shift + 0.5};
    double before = -1e9;
    for (const double z : {-6.0, -1.0, 0.0, 0.7, 3.0, 7.0}) {
      const double x = value_at(cut, z);
      EXPECT_GE(x, cut.min);
      EXPECT_LE(x, cut.max);
      EXPECT_GE(x, before);
      before = x;
      // The share below x of what is between the limits, from the tail that has digits.
      const double side = shift > 0 ? -1 : 1;
      const auto tail = [&](double at) { return boost::math::cdf(normal, side * at); };
      const double share =
          (tail(x) - tail(side > 0 ? cut.min : cut.max)) /
          (tail(side > 0 ? cut.max : cut.min) - tail(side > 0 ? cut.min : cut.max));
      EXPECT_NEAR(share, boost::math::cdf(normal, side * z), 1e-9) << shift << " " << z;
    }
  }
}

TEST(Uncertainty, CorrelationIsThatOfTheNormalNumbers) {
  Uncertainty uncertainty{{{"mass", {DistributionKind::normal, 1, 0.05}},
                           {"inertia_x", {DistributionKind::normal, 1, 0.1}},
                           {"wind_north", {DistributionKind::normal, 0, 2}}},
                          MatrixXd::Identity(3, 3)};
  uncertainty.correlation(0, 1) = uncertainty.correlation(1, 0) = 0.8;
  const MatrixXd all = draws(uncertainty);
  const MatrixXd centred = all.rowwise() - all.colwise().mean();
  const MatrixXd C = centred.transpose() * centred;
  const auto correlation = [&](int i, int j) { return C(i, j) / std::sqrt(C(i, i) * C(j, j)); };
  EXPECT_NEAR(correlation(0, 1), 0.8, 4 * 0.36 / std::sqrt(double{kDraws}));
  EXPECT_NEAR(correlation(0, 2), 0, 4 / std::sqrt(double{kDraws}));
}

TEST(Uncertainty, DrawsDependOnSeedFlightAndQuantityAlone) {
  const UncertainNumber mass{"mass", {DistributionKind::normal, 1, 0.05}};
  const UncertainNumber wind{"wind_north", {DistributionKind::normal, 0, 2}};
  const Uncertainty one{{mass}, {}}, two{{wind, mass}, {}};
  for (std::uint32_t i = 0; i < 10; ++i) EXPECT_EQ(draw(one, 5, i)(0), draw(two, 5, i)(1));
  EXPECT_NE(draw(one, 5, 0)(0), draw(one, 5, 1)(0));
  EXPECT_NE(draw(one, 5, 0)(0), draw(one, 6, 0)(0));
}

// Every quantity leaves the flight as it is at what changes nothing, and changes it elsewhere.
TEST(Uncertainty, EveryQuantityChangesWhatItSays) {
  FlightSetup setup;
  setup.vehicle = load_vehicle("mambo");
  setup.mission = load_mission("hover");
  setup.controller = testing::designed_mambo_cascade();
  setup.vehicle.battery = Battery{1000, 4.2, 3.2, 0.1, 3, 0.7, 0, 4};
  setup.vehicle.drag.cda.setConstant(0.01);
  for (Rotor& rotor : setup.vehicle.rotors) rotor.lag = 0.02;
  setup.vehicle.sensors.gps.emplace();
  setup.vehicle.sensors.gps->position = *setup.vehicle.sensors.accelerometer;
  setup.vehicle.sensors.vision = setup.vehicle.sensors.accelerometer;
  setup.vehicle.sensors.magnetometer = setup.vehicle.sensors.accelerometer;
  setup.vehicle.sensors.barometer.emplace();
  int known = 0;
  for (const UncertainQuantity& quantity : uncertain_quantities()) {
    if (quantity.name > "thrust_4" && quantity.name <= "thrust_8") continue;  // it has four rotors
    const double nothing = quantity.kind == QuantityKind::ratio ? 1 : 0;
    const Uncertainty uncertainty{{{quantity.name, {}}}, {}};
    FlightSetup same = setup;
    apply(uncertainty, VectorXd::Constant(1, nothing), same);
    ASSERT_TRUE(same.flown);
    if (quantity.kind != QuantityKind::value) {
      EXPECT_EQ(same.flown->mass, setup.vehicle.mass);
      EXPECT_EQ(same.flown->inertia, setup.vehicle.inertia);
      EXPECT_TRUE(same.environment.wind.mean.isZero(0));
    }
    ++known;
  }
  EXPECT_GT(known, 80);

  const auto applied = [&](const std::string& name, double value) {
    FlightSetup changed = setup;
    apply({{{name, {}}}, {}}, VectorXd::Constant(1, value), changed);
    EXPECT_EQ(changed.vehicle.mass, setup.vehicle.mass);  // what is believed stays
    return changed;
  };
  EXPECT_DOUBLE_EQ(applied("mass", 1.2).flown->mass, 1.2 * setup.vehicle.mass);
  EXPECT_DOUBLE_EQ(applied("inertia_y", 1.2).flown->inertia(1, 1),
                   1.2 * setup.vehicle.inertia(1, 1));
  EXPECT_EQ(applied("inertia_y", 1.2).flown->inertia(0, 0), setup.vehicle.inertia(0, 0));
  EXPECT_DOUBLE_EQ(applied("thrust", 0.9).flown->rotors[2].thrust_a2,
                   0.9 * setup.vehicle.rotors[2].thrust_a2);
  EXPECT_DOUBLE_EQ(applied("thrust_3", 0.9).flown->rotors[2].thrust_a2,
                   0.9 * setup.vehicle.rotors[2].thrust_a2);
  EXPECT_EQ(applied("thrust_3", 0.9).flown->rotors[1].thrust_a2, setup.vehicle.rotors[1].thrust_a2);
  EXPECT_DOUBLE_EQ(applied("centre_of_mass_x", 0.01).flown->rotors[0].position.x(),
                   setup.vehicle.rotors[0].position.x() - 0.01);
  EXPECT_EQ(applied("wind_east", 2).environment.wind.mean.y(), 2);
  EXPECT_EQ(applied("turbulence", 7).environment.wind.turbulence, 7);
  EXPECT_EQ(applied("gyroscope_bias_z", 0.1).flown->sensors.gyroscope->bias.z(),
            setup.vehicle.sensors.gyroscope->bias.z() + 0.1);
  EXPECT_DOUBLE_EQ(applied("sonar_noise", 2).flown->sensors.sonar->faults.noise.x(),
                   2 * setup.vehicle.sensors.sonar->faults.noise.x());
  EXPECT_EQ(applied("sonar_deviation", 0.3).flown->sensors.sonar->faults.noise.x(), 0.3);
  EXPECT_EQ(applied("flow_delay", 0.02).flown->sensors.flow->faults.delay,
            setup.vehicle.sensors.flow->faults.delay + 0.02);
  EXPECT_EQ(applied("gps_dropout", 0.2).flown->sensors.gps->position.dropout, 0.2);
  EXPECT_DOUBLE_EQ(applied("battery_voltage", 0.9).flown->battery->full_voltage, 0.9 * 4.2);
}

const char* word_of(QuantityKind kind) {
  return kind == QuantityKind::ratio      ? "ratio"
         : kind == QuantityKind::addition ? "addition"
                                          : "value";
}

/// Texts that differ in one place alone, as one: "wind towards north, east, down".
std::string together(const std::vector<std::string>& texts) {
  const std::string& first = texts.front();
  const std::string& last = texts.back();
  const auto n = static_cast<std::ptrdiff_t>(std::min(first.size(), last.size()));
  const auto begin = std::mismatch(first.begin(), first.begin() + n, last.begin()).first;
  const auto end =
      std::mismatch(first.rbegin(), first.rbegin() + (n - (begin - first.begin())), last.rbegin())
          .first;
  const auto before = static_cast<std::size_t>(begin - first.begin());
  const auto after = static_cast<std::size_t>(end - first.rbegin());
  std::string parts;
  for (const std::string& text : texts)
    parts += (parts.empty() ? "" : ", ") + text.substr(before, text.size() - before - after);
  return first.substr(0, before) + parts + first.substr(first.size() - after);
}

/// Rows of the documentation: what differs by the axis or the rotor alone shares one.
std::string quantity_rows() {
  const std::vector<UncertainQuantity>& all = uncertain_quantities();
  const auto stem = [](const UncertainQuantity& q) {
    return q.name.substr(0, q.name.find_last_of('_'));
  };
  std::string text;
  for (std::size_t i = 0; i < all.size();) {
    std::size_t end = i + 1;
    while (end < all.size() && all[i].name.find('_') != std::string::npos &&
           stem(all[end]) == stem(all[i]) && all[end].unit == all[i].unit &&
           all[end].kind == all[i].kind && all[end].max == all[i].max &&
           all[end].meaning.substr(0, 8) == all[i].meaning.substr(0, 8))
      ++end;
    std::vector<std::string> names, meanings;
    for (std::size_t k = i; k < end; ++k) {
      names.push_back("`" + all[k].name + "`");
      meanings.push_back(all[k].meaning);
    }
    text += fmt::format("| {} | {} | {} | {:g} | {:g} | {} |\n", fmt::join(names, ", "),
                        all[i].unit, word_of(all[i].kind), all[i].min, all[i].max,
                        end - i == 1 ? all[i].meaning : together(meanings));
    i = end;
  }
  return text;
}

TEST(Uncertainty, DocumentationListsEveryQuantity) {
  const std::string name = "docs/formats.md";
  std::ifstream file(std::filesystem::path(testing::source_folder()) / name);
  const std::string stands(std::istreambuf_iterator<char>(file), {});
  const std::string head =
      "| quantity | unit | kind | from | to | what |\n|---|---|---|---:|---:|---|\n";
  const std::size_t begin = stands.find(head),
                    end = stands.find("<!-- end of what the test writes");
  ASSERT_NE(begin, std::string::npos);
  ASSERT_NE(end, std::string::npos);
  EXPECT_TRUE(testing::matches_document(
      name, stands.substr(0, begin + head.size()) + quantity_rows() + "\n" + stands.substr(end)));
}

TEST(Uncertainty, RefusesWhatTheVehicleLacks) {
  FlightSetup setup;
  setup.vehicle = load_vehicle("mambo");
  setup.vehicle.sensors.gps.reset();
  const auto applied = [&](const std::string& name) {
    return [&setup, name] {
      FlightSetup changed = setup;
      apply({{{name, {}}}, {}}, VectorXd::Ones(1), changed);
    };
  };
  EXPECT_THAT(applied("gps_noise"),
              ThrowsMessage<InvalidInput>(
                  StrEq("gps_noise: the file of the vehicle 'mambo' has nothing that this quantity "
                        "(noise of the GPS receiver) changes")));
  EXPECT_THAT(applied("thrust_5"), ThrowsMessage<InvalidInput>(HasSubstr("thrust_5: ")));
  // Wind moves a vehicle by its drag alone, and the Mambo's file has none.
  EXPECT_THAT(applied("drag"),
              ThrowsMessage<InvalidInput>(
                  HasSubstr("has nothing that this quantity (drag of body and rotors) changes")));
  for (const char* name : {"wind_north", "gust_down", "gust_at", "gust_length", "turbulence"})
    EXPECT_THAT(applied(name), ThrowsMessage<InvalidInput>(HasSubstr("'mambo' has no drag")))
        << name;
  setup.real_sensors = false;
  EXPECT_THAT(applied("gyroscope_noise"),
              ThrowsMessage<InvalidInput>(HasSubstr("the flight has ideal sensors")));
}

TEST(UncertaintyFile, ReadsAllDistributions) {
  const Uncertainty read_back = read(R"(
[[vary]]
quantity = "mass"
normal = { deviation = 0.03, least = 0.9, most = 1.1 }
[[vary]]
quantity = "inertia_x"
uniform = { low = 0.8, high = 1.2 }
[[vary]]
quantity = "drag"
log_normal = { deviation = 0.3 }
[[vary]]
quantity = "turbulence"
normal = { mean = 5, deviation = 0.5 }
[[correlation]]
quantities = ["mass", "inertia_x"]
value = 0.7
)");
  ASSERT_EQ(read_back.numbers.size(), 4);
  EXPECT_EQ(read_back.numbers[0],
            (UncertainNumber{"mass", {DistributionKind::normal, 1, 0.03, 0.9, 1.1}}));
  EXPECT_EQ(read_back.numbers[1],
            (UncertainNumber{"inertia_x", {DistributionKind::uniform, 0.8, 1.2}}));
  EXPECT_EQ(read_back.numbers[2],
            (UncertainNumber{"drag", {DistributionKind::log_normal, 1, 0.3}}));
  MatrixXd expected = MatrixXd::Identity(4, 4);
  expected(0, 1) = expected(1, 0) = 0.7;
  EXPECT_THAT(read_back.correlation, MatrixNear(expected, 0));
}

// The interval of a variance's logarithm is ± 1.96 deviations; a deviation has half of them.
TEST(UncertaintyFile, TakesAFittedVarianceWithItsInterval) {
  const testing::TemporaryDirectory folder;
  folder.write("tuned.toml", R"(
name = "height"
states = ["z [m]"]
noises = ["w"]
A = [[0]]
G = [[1]]
[[Q]]
variance = 1
[[sensors]]
name = "sonar"
outputs = ["z [m]"]
C = [[1]]
[[sensors.R]]
parameter = "R.sonar"
variance = 0.04
interval = [0.03, 0.05]
)");
  const std::string text = R"(
[[vary]]
quantity = "sonar_deviation"
fitted = { file = "tuned.toml", parameter = "R.sonar" }
)";
  const Uncertainty fitted = read(text, folder.path());
  const Distribution& d = fitted.numbers[0].distribution;
  EXPECT_EQ(d.kind, DistributionKind::log_normal);
  EXPECT_DOUBLE_EQ(d.first, 0.2);
  EXPECT_NEAR(d.second, 0.5 * std::log(0.05 / 0.03) / (2 * 1.96), 1e-5);
  std::string other = text;
  other.replace(other.find("sonar_deviation"), 15, "sonar_noise");
  EXPECT_THAT([&] { (void)read(other, folder.path()); },
              ThrowsMessage<InvalidInput>(HasSubstr("standard deviation, e.g. sonar_deviation")));
  other = text;
  other.replace(other.find("R.sonar"), 7, "Q.w");
  EXPECT_THAT([&] { (void)read(other, folder.path()); },
              ThrowsMessage<InvalidInput>(HasSubstr("Q.w of the model 'height' has no interval")));
}

TEST(UncertaintyFile, RefusesWhatIsNoDistribution) {
  const auto refuses = [](const std::string& text, const std::string& message) {
    EXPECT_THAT([&] { (void)read(text); }, ThrowsMessage<InvalidInput>(HasSubstr(message))) << text;
  };
  const std::string mass = "[[vary]]\nquantity = \"mass\"\n";
  refuses("[[vary]]\nquantity = \"mas\"\nnormal = {deviation = 1}\n",
          "f.toml:2: no quantity 'mas', expected one of those in docs/formats.md");
  refuses("[[vary]]\nquantity = \"gust_at\"\nuniform = {low = -1, high = 2}\n",
          "gust_at: the draws extend from -1 to 2 s, expected within 0 to 86400");
  refuses("[[vary]]\nquantity = \"inertia_w\"\n", "did you mean 'inertia_x'?");
  refuses(mass, "f.toml:1: [[vary]] 1 has no distribution, expected one of normal");
  refuses(mass + "normal = {deviation = 0.1}\nuniform = {low = 0.9, high = 1}\n",
          "has normal and uniform, expected one of");
  refuses(mass + "normal = {deviation = -0.1}\n", "mass: deviation is -0.1, expected 0 or more");
  refuses(mass + "normal = {deviatoin = 0.1}\n", "deviatoin");
  refuses(mass + "uniform = {low = 1.2, high = 0.8}\n",
          "mass: low is 1.2 and high is 0.8, expected low at most high");
  refuses(
      mass + "normal = {deviation = 0.5}\n",
      "mass: the draws extend from -3 to 5, expected within 0.01 to 100; the keys least and most");
  refuses(mass + "normal = {deviation = 0.1, least = 1.1, most = 0.9}\n",
          "least is 1.1 and most is 0.9, expected least below most");
  refuses(mass + "normal = {deviation = 0.01, least = 2}\n", "expected an overlap");
  refuses(mass + "log_normal = {median = 0, deviation = 0.1}\n",
          "mass: median is 0, expected more than 0");
  const std::string three =
      mass +
      "normal = {deviation = 0.01}\n[[vary]]\nquantity = \"thrust\"\nnormal = {deviation = "
      "0.01}\n[[vary]]\nquantity = \"drag\"\nnormal = {deviation = 0.01}\n";
  refuses(three + mass + "normal = {deviation = 0.01}\n", "mass is given twice");
  refuses(three + "[[correlation]]\nquantities = [\"mass\", \"thrst\"]\nvalue = 0.5\n",
          "f.toml:11: 'thrst' is not an uncertain quantity of this file, expected some of mass, "
          "thrust, drag; did you mean 'thrust'?");
  refuses(three + "[[correlation]]\nquantities = [\"mass\"]\nvalue = 0.5\n",
          "quantities has 1 entry, expected 2 or more");
  refuses(three + "[[correlation]]\nquantities = [\"mass\", \"thrust\"]\nvalue = 1\n",
          "more than -1 and less than 1");
  refuses(three + "[[correlation]]\nquantities = [\"mass\", \"thrust\", \"drag\"]\nvalue = -0.6\n",
          "the correlations of mass, thrust, drag have the eigenvalue -0.2, expected a positive "
          "definite matrix");
  refuses(three +
              "[[correlation]]\nquantities = [\"mass\", \"thrust\"]\nvalue = 0.1\n"
              "[[correlation]]\nquantities = [\"thrust\", \"mass\"]\nvalue = 0.1\n",
          "the correlation of thrust and mass is given twice, expected each pair once");
  refuses(three + "[[correlation]]\nquantities = [\"mass\", \"mass\"]\nvalue = 0.1\n",
          "f.toml:11: mass is given twice, expected each quantity once");
  refuses(
      "[[correlation]]\nquantities = [\"mass\", \"thrust\"]\nvalue = 0.1\n",
      "f.toml:2: 'thrust' is not an uncertain quantity of this file, expected a [[vary]] for it");
}

}  // namespace
}  // namespace quadtune
