// SPDX-License-Identifier: Apache-2.0
/// Pages that tests open in a browser, and what they read from them.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "browser.hpp"
#include "sanitized.hpp"
#include "source_folder.hpp"
#include "temporary_directory.hpp"

namespace quadtune::testing {

/// The data of a page.
[[nodiscard]] nlohmann::json data_of(const std::string& page);

/// The value of a data attribute of the page's root element; "(none)" where it is absent.
[[nodiscard]] std::string root_data(const std::string& page, const std::string& name);

/// The page without its policy and with a script of the test, which runs after the page is drawn.
/// Values that the script stores in document.documentElement.dataset can be read with root_data().
[[nodiscard]] std::string with_script(const std::string& html, const std::string& script);

/// The requests of web pages in a run with --log-net-log, from its log; requests of the browser
/// itself are omitted.
[[nodiscard]] std::set<std::string> requests(const std::string& log);

/// A page that shows another one, given by its name in the same folder, in a frame, because a
/// window cannot be as narrow as a telephone. Messages of the other page go into data-inside.
[[nodiscard]] std::string in_frame(const std::string& name, int width, int height);

/// Skips the test if there is no browser.
class Browser : public ::testing::Test {
 protected:
  void SetUp() override {
    if (find_browser().empty()) GTEST_SKIP() << "no chromium here, so no page is opened";
    if (kSanitized)
      GTEST_SKIP()
          << "Chromium is not instrumented; the tests of the page's text run under sanitizers";
  }

  std::string write(const std::string& html, const std::string& name = "report.html") const {
    return place_.write(name, html).string();
  }

  /// The page after its scripts have run.
  std::string opened(const std::string& html,
                     const std::vector<std::string>& arguments = {}) const {
    const BrowserResult result = dump_page(write(html), arguments);
    EXPECT_TRUE(result.in_time) << "the browser did not end";
    EXPECT_EQ(result.status, 0);
    return result.out;
  }

  /// The network requests of a page.
  std::set<std::string> asked_for(const std::string& html) const {
    const std::string log = (place_.path() / "requests.json").string();
    (void)opened(html, {"--log-net-log=" + log});
    std::set<std::string> asked = requests(place_.read("requests.json"));
    std::filesystem::remove(log);
    return asked;
  }

  /// The page after its scripts have run, with the number of elements that a text must not create
  /// in `elements`.
  std::string opened_and_counted(const std::string& html) const {
    return opened(
        with_script(html,
                    "document.documentElement.dataset.elements = document.querySelectorAll("
                    "'main img, main script, main b[onclick], main iframe, main a').length"));
  }

  /// The width of a page in a window that is as wide as a telephone, 390 px.
  std::string narrow_width(const std::string& html) const {
    write(with_script(html, "parent.postMessage(document.documentElement.scrollWidth, '*')"),
          "inner.html");
    return root_data(opened(in_frame("inner.html", 390, 800)), "inside");
  }

  /// With QUADTUNE_UPDATE_DOCS=1 in the environment, the picture replaces that of the
  /// documentation.
  void take_picture_for_docs(const std::string& html, const std::string& name, int height) const {
    const std::string png = (place_.path() / name).string();
    EXPECT_EQ(take_picture(write(html), png, 1400, height).status, 0);
    EXPECT_GT(std::filesystem::file_size(png), 60'000U);  // an empty page has about 10 kB
    if (std::getenv("QUADTUNE_UPDATE_DOCS") != nullptr)
      std::filesystem::copy_file(png, testing::source_folder() + "/docs/images/" + name,
                                 std::filesystem::copy_options::overwrite_existing);
  }

  TemporaryDirectory place_;
};

}  // namespace quadtune::testing
