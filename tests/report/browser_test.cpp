// SPDX-License-Identifier: Apache-2.0
/// The flight report in a browser. Skipped if there is no Chromium.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "browser_page.hpp"
#include "hostile_texts.hpp"
#include "run_program.hpp"
#include "sample_flight.hpp"
#include "source_folder.hpp"
#include "temporary_directory.hpp"

namespace quadtune::testing {
namespace {

using report::FlightReport;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST_F(Browser, DrawsEveryPlotAndTheReplay) {
  const std::string page = opened(report::html(sample_flight()));
  EXPECT_EQ(root_data(page, "error"), "(none)");
  EXPECT_EQ(root_data(page, "plots"), "8");
  EXPECT_EQ(root_data(page, "replay"), "drawn");
  EXPECT_THAT(page, HasSubstr("8 of 9 limits met"));
  EXPECT_THAT(page, HasSubstr("extended Kalman filter, every 5 ms"));
  EXPECT_THAT(page, HasSubstr("rotor 2 within 10 % of its largest speed"));
}

// Coloured lines, not only grids and texts.
TEST_F(Browser, PlotsAndReplayHaveColours) {
  const std::string script = R"(
    const root = document.documentElement;
    const colourful = (canvas) => {
      const copy = document.createElement('canvas');
      copy.width = canvas.width;
      copy.height = canvas.height;
      const ctx = copy.getContext('2d');
      ctx.drawImage(canvas, 0, 0);
      const {data} = ctx.getImageData(0, 0, copy.width, copy.height);
      let count = 0;
      for (let i = 0; i < data.length; i += 4)
        if (data[i + 3] > 128 && Math.max(data[i], data[i + 1], data[i + 2]) -
            Math.min(data[i], data[i + 1], data[i + 2]) > 60) ++count;
      return count;
    };
    flightReport.replay.render();
    root.dataset.plotted = [...document.querySelectorAll('.plot canvas')].map(colourful).join(' ');
    root.dataset.replayed = colourful(document.querySelector('.stage canvas'));
  )";
  const std::string page = opened(with_script(report::html(sample_flight()), script));
  EXPECT_EQ(root_data(page, "error"), "(none)");
  std::istringstream plotted(root_data(page, "plotted"));
  int plots = 0;
  for (int pixels = 0; plotted >> pixels; ++plots) EXPECT_GT(pixels, 400) << "plot " << plots;
  EXPECT_EQ(plots, 8);
  EXPECT_GT(std::stoi(root_data(page, "replayed")), 3000);
}

TEST_F(Browser, ShowsTheFlightFromAboveWithoutWebGl) {
  const std::string page = opened(report::html(sample_flight()), {"--disable-3d-apis"});
  EXPECT_EQ(root_data(page, "error"), "(none)");
  EXPECT_EQ(root_data(page, "plots"), "8");
  EXPECT_EQ(root_data(page, "replay"), "flat");
  EXPECT_THAT(page, HasSubstr("This browser has no WebGL, so the flight is shown from above."));
}

TEST_F(Browser, ShowsAReportOfNothing) {
  const std::string page = opened(report::html(FlightReport{}));
  EXPECT_EQ(root_data(page, "error"), "(none)");
  EXPECT_EQ(root_data(page, "plots"), "0");
  EXPECT_EQ(root_data(page, "replay"), "none");
  EXPECT_THAT(page, HasSubstr("No verdict"));
}

// Also without its policy, which is only a second barrier.
TEST_F(Browser, LoadsNothing) {
  const std::string html = report::html(sample_flight());
  const std::string image =
      "document.body.append(Object.assign(new Image(), "
      "{src: 'http://control.example/x.png'}));";
  EXPECT_THAT(asked_for(with_script(html, image)),
              ::testing::ElementsAre("http://control.example/x.png"));  // so the log contains
                                                                        // requests
  EXPECT_THAT(asked_for(with_script(html, "")), IsEmpty());
  EXPECT_THAT(asked_for(html), IsEmpty());
}

TEST_F(Browser, PolicyStopsOtherScripts) {
  std::string html = report::html(sample_flight(4));
  html.insert(html.rfind("</body>"),
              "<script>document.documentElement.dataset.alien = 'ran'</script>");
  const std::string page = opened(html);
  EXPECT_EQ(root_data(page, "plots"), "8");
  EXPECT_EQ(root_data(page, "alien"), "(none)");
}

TEST_F(Browser, HostileTextsStayTexts) {
  FlightReport report = hostile_flight();
  // Every text is shown, none as markup, and no script in it runs, also without the policy.
  const std::string page =
      opened(with_script(report::html(report),
                         "const root = document.documentElement; root.dataset.elements = "
                         "document.querySelectorAll('main img, main script, main b[onclick], main "
                         "iframe, main svg[onload], main a').length; root.dataset.heading = "
                         "document.querySelector('h1').textContent.length;"));
  EXPECT_EQ(root_data(page, "error"), "(none)");
  EXPECT_EQ(root_data(page, "broken"), "(none)");
  EXPECT_EQ(root_data(page, "plots"), std::to_string(report.plots.size()));
  EXPECT_EQ(root_data(page, "replay"), "drawn");
  EXPECT_EQ(root_data(page, "elements"), "0");
  EXPECT_NE(root_data(page, "heading"), "0");
}

// Positions of the rotors in the picture [px], with the camera at a position relative to the
// vehicle [m].
class Attitude : public Browser {
 protected:
  /// Pixel columns x and y, in the order front left, front right, back right, back left.
  std::vector<std::pair<double, double>> seen(double roll, double pitch, double yaw,
                                              const std::string& from) {
    const std::string script = fmt::format(
        "flightReport.replay.look({}); document.documentElement.dataset.seen = "
        "[[.2,-.2,0],[.2,.2,0],[-.2,.2,0],[-.2,-.2,0]].map(flightReport.replay.project).flat()"
        ".map((v) => v.toFixed(2)).join(' ');",
        from);
    const std::string page =
        opened(with_script(report::html(still_flight(roll, pitch, yaw)), script));
    EXPECT_EQ(root_data(page, "error"), "(none)");
    std::istringstream text(root_data(page, "seen"));
    std::vector<std::pair<double, double>> places;
    for (double x = 0, y = 0; text >> x >> y;) places.emplace_back(x, y);
    places.resize(4);
    return places;
  }
  const std::string behind = "[-2, 0, 0]";
  const std::string above = "[-0.001, 0, -2]";  // with north at the top of the picture
};

TEST_F(Attitude, LevelAndNorth) {
  const auto back = seen(0, 0, 0, behind);
  EXPECT_LT(back[3].first, back[2].first);           // left is left
  EXPECT_NEAR(back[2].second, back[3].second, 0.1);  // level
  const auto top = seen(0, 0, 0, above);
  EXPECT_LT(top[0].second, top[3].second);  // forward is north, which is up in the picture
  EXPECT_LT(top[0].first, top[1].first);    // right is east, which is right in the picture
}

TEST_F(Attitude, RollLowersTheRightSide) {
  const auto back = seen(0.4, 0, 0, behind);
  EXPECT_GT(back[2].second, back[3].second + 5);  // pixels count downward
}

TEST_F(Attitude, PitchLiftsTheNose) {
  const auto back = seen(0, 0.4, 0, behind);
  EXPECT_LT(back[0].second, back[3].second - 5);
}

TEST_F(Attitude, YawTurnsClockwiseSeenFromAbove) {
  const auto top = seen(0, 0, 0.4, above);
  const double ahead = (top[0].first + top[1].first) / 2;
  const double behind_it = (top[2].first + top[3].first) / 2;
  EXPECT_GT(ahead, behind_it + 5);  // the nose moved to the right
}

TEST_F(Browser, PlotsReplayAndScrubBarShareOneTime) {
  const std::string html = report::html(sample_flight());
  const std::string script = R"(
    // The virtual clock of the browser runs fast, and it draws hardly any frames.
    window.requestAnimationFrame = (f) => setTimeout(f, 100);
    const root = document.documentElement;
    const over = [...document.querySelectorAll('.u-over')];
    const at = (box, type, share) => {
      const r = box.getBoundingClientRect();
      box.dispatchEvent(new MouseEvent(type, {bubbles: true, button: 0, movementX: 1,
        clientX: r.left + share * r.width, clientY: r.top + r.height / 2}));
    };
    at(over[0], 'mouseenter', 0.5);
    at(over[0], 'mousemove', 0.5);
    const lines = over.map((o) => new DOMMatrix(getComputedStyle(
      o.querySelector('.u-cursor-x')).transform).m41 / o.clientWidth);
    root.dataset.spread = (Math.max(...lines) - Math.min(...lines)).toFixed(3);
    root.dataset.line = lines[3].toFixed(2);
    root.dataset.scrub = Number(document.querySelector('.scrub').value).toFixed(1);
    at(over[2], 'mousedown', 0.25);
    at(over[2], 'mousemove', 0.5);
    at(over[2], 'mouseup', 0.5);
    setTimeout(() => {
      root.dataset.zoomed = String(!document.querySelector('.reset').disabled);
      flightReport.seek(15);
      root.dataset.middle = (new DOMMatrix(getComputedStyle(over[5].querySelector(
        '.u-cursor-x')).transform).m41 / over[5].clientWidth).toFixed(2);
      at(over[1], 'dblclick', 0.5);
      setTimeout(() => {
        root.dataset.whole = String(document.querySelector('.reset').disabled);
        flightReport.seek(0);
        document.querySelector('.play').click();
        setTimeout(() => {
          root.dataset.played = Number(document.querySelector('.scrub').value).toFixed(2);
          document.querySelector('.play').click();
        }, 1000);
      }, 100);
    }, 100);
  )";
  const std::string page = opened(with_script(html, script));
  EXPECT_EQ(root_data(page, "error"), "(none)");
  EXPECT_EQ(root_data(page, "line"), "0.50");
  EXPECT_LT(std::stod(root_data(page, "spread")), 0.01);
  EXPECT_NEAR(std::stod(root_data(page, "scrub")), 20, 0.2);
  EXPECT_EQ(root_data(page, "zoomed"), "true");
  EXPECT_NEAR(std::stod(root_data(page, "middle")), 0.5, 0.02);  // of 10 s to 20 s
  EXPECT_EQ(root_data(page, "whole"), "true");
  EXPECT_GT(std::stod(root_data(page, "played")), 0.3);
  EXPECT_LT(std::stod(root_data(page, "played")), 2);
}

TEST_F(Browser, PlotsObeyTheKeyboard) {
  const std::string script = R"(
    const root = document.documentElement;
    const plot = document.querySelectorAll('.plot')[4];
    const press = (key) => plot.dispatchEvent(new KeyboardEvent('keydown', {key, bubbles: true}));
    const time = () => Number(document.querySelector('.scrub').value).toFixed(2);
    press('End');
    root.dataset.end = time();
    press('Home');
    press('ArrowRight');
    root.dataset.right = time();
    press('+');
    const key = plot.querySelector('.key');
    key.click();
    root.dataset.hidden = key.getAttribute('aria-pressed');
    document.querySelectorAll('.events button')[2].click();
    root.dataset.event = time();
    document.querySelector('.theme').click();
    setTimeout(() => {
      root.dataset.nearer = String(!document.querySelector('.reset').disabled);
      press('0');
      setTimeout(() => {
        root.dataset.whole = String(document.querySelector('.reset').disabled);
      }, 50);
    }, 50);
  )";
  const std::string page = opened(with_script(report::html(sample_flight()), script));
  EXPECT_EQ(root_data(page, "error"), "(none)");
  EXPECT_EQ(root_data(page, "end"), "40.00");
  EXPECT_EQ(root_data(page, "right"), "0.20");
  EXPECT_EQ(root_data(page, "hidden"), "false");
  EXPECT_EQ(root_data(page, "event"), "19.80");
  EXPECT_EQ(root_data(page, "theme"), "dark");
  EXPECT_EQ(root_data(page, "nearer"), "true");
  EXPECT_EQ(root_data(page, "whole"), "true");
}

TEST_F(Browser, FitsIntoANarrowWindow) {
  for (const FlightReport& report : {sample_flight(4), hostile_flight()}) {
    EXPECT_EQ(narrow_width(report::html(report)), "390") << report.title;
  }
}

/// Width and height of a PNG [px]; 0, 0 for anything else.
std::pair<unsigned, unsigned> png_size(const std::string& bytes) {
  if (bytes.size() < 24 || bytes.substr(1, 3) != "PNG") return {0, 0};
  const auto number = [&](std::size_t at) {
    unsigned value = 0;
    for (std::size_t i = at; i < at + 4; ++i)
      value = value << 8 | static_cast<unsigned char>(bytes[i]);
    return value;
  };
  return {number(16), number(20)};
}

// With QUADTUNE_UPDATE_DOCS=1 in the environment, the flight is simulated by the command that the
// README shows, and the wide picture becomes that of the README.
TEST_F(Browser, TakesPicturesWideAndNarrow) {
  const bool for_readme = std::getenv("QUADTUNE_UPDATE_DOCS") != nullptr;
  const std::string wide = (place_.path() / "wide.png").string();
  const std::string narrow = (place_.path() / "narrow.png").string();
  std::string page = report::html(sample_flight());
  if (for_readme) {
    const std::string report = (place_.path() / "flown.html").string();
    ASSERT_EQ(run_program({"fly", "mambo", "--mission", "lemniscate", "--report", report}).status,
              0);
    page = place_.read("flown.html");
  }
  const std::string html = with_script(page, "flightReport.seek(21.4)");
  const std::string file = write(html);
  EXPECT_EQ(take_picture(file, wide, 1400, 1350).status, 0);
  EXPECT_EQ(png_size(place_.read("wide.png")), std::pair(1400U, 1350U));
  const std::string frame = write(in_frame("report.html", 390, 2000), "frame.html");
  EXPECT_EQ(take_picture(frame, narrow, 500, 2000).status, 0);
  EXPECT_EQ(png_size(place_.read("narrow.png")), std::pair(500U, 2000U));
  // An empty page has about 10 kB.
  EXPECT_GT(std::filesystem::file_size(wide), 60'000U);
  EXPECT_GT(std::filesystem::file_size(narrow), 40'000U);
  if (for_readme)
    std::filesystem::copy_file(wide, testing::source_folder() + "/docs/images/flight-report.png",
                               std::filesystem::copy_options::overwrite_existing);
}

}  // namespace
}  // namespace quadtune::testing
