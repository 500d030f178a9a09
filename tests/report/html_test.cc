#include "comparisons/report/html.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "comparisons/report/page.h"

namespace softfinger::report {
namespace {

// Only our own literals become markup: none of the other constructions compiles.
static_assert(std::is_constructible_v<Html, const char (&)[5]>);
static_assert(!std::is_constructible_v<Html, char (&)[5]>, "a buffer that was filled");
static_assert(!std::is_constructible_v<Html, const char*>);
static_assert(!std::is_constructible_v<Html, std::string>);
static_assert(!std::is_constructible_v<Html, std::string_view>);
static_assert(!std::is_assignable_v<Html&, std::string>);
static_assert(!std::is_assignable_v<Html&, const char*>);
// Nor does markup become a text implicitly, which would be escaped a second time.
static_assert(!std::is_convertible_v<Html, std::string>);
static_assert(!std::is_convertible_v<Html, std::string_view>);

template <typename One, typename Other, typename = void>
constexpr bool add_up = false;
template <typename One, typename Other>
constexpr bool
    add_up<One, Other, std::void_t<decltype(std::declval<One>() + std::declval<Other>())>> = true;
static_assert(add_up<Html, Html> && add_up<Html, const char (&)[5]> &&
              add_up<const char (&)[5], Html>);
static_assert(!add_up<Html, std::string> && !add_up<std::string, Html>);
static_assert(!add_up<Html, std::string_view> && !add_up<Html, const char*>);

template <typename Part, typename = void>
constexpr bool appends = false;
template <typename Part>
constexpr bool appends<Part, std::void_t<decltype(std::declval<Html&>() += std::declval<Part>())>> =
    true;
static_assert(appends<Html> && appends<const char (&)[5]>);
static_assert(!appends<std::string> && !appends<std::string_view> && !appends<const char*>);

// The skeleton takes markup, not text.
static_assert(!std::is_assignable_v<decltype(Page::body)&, std::string>);
static_assert(!std::is_assignable_v<decltype(Page::title)&, std::string>);

constexpr const char* kHostile = "</td><script>alert(\"1\")</script>&'";
constexpr const char* kHarmless =
    "&lt;/td&gt;&lt;script&gt;alert(&quot;1&quot;)&lt;/script&gt;&amp;&#39;";

TEST(Html, EscapesEveryKindOfText) {
  const std::string expected = std::string("<td>") + kHarmless + "</td>";
  EXPECT_EQ(escape(kHostile).markup(), kHarmless);
  EXPECT_EQ(html("<td>{}</td>", kHostile).markup(), expected);
  EXPECT_EQ(html("<td>{}</td>", std::string(kHostile)).markup(), expected);
  EXPECT_EQ(html("<td>{}</td>", std::string_view(kHostile)).markup(), expected);
  EXPECT_EQ(html("<td>{}</td>", "a & b").markup(), "<td>a &amp; b</td>");
}

TEST(Html, LeavesMarkupAndNumbersAsTheyAre) {
  EXPECT_EQ(html("<td>{}</td>", Html("<b>1 &lt; 2</b>")).markup(), "<td><b>1 &lt; 2</b></td>");
  EXPECT_EQ(html("{} {} {:g} {:.1f} {}", -3, std::size_t{7}, 0.5, 2.25, true).markup(),
            "-3 7 0.5 2.2 true");
  constexpr auto kLargest = std::numeric_limits<std::size_t>::max();
  EXPECT_EQ(html("{}", kLargest).markup(), std::to_string(kLargest));
}

TEST(Html, NeverSearchesWhatWasInsertedForPlaces) {
  EXPECT_EQ(html("<td>{}</td>", "{} {0} {{").markup(), "<td>{} {0} {{</td>");
}

TEST(Html, PutsASeparatorBetweenPartsOnly) {
  EXPECT_EQ(joined({}, "<br>").markup(), "");
  EXPECT_EQ(joined({"a"}, "<br>").markup(), "a");
  EXPECT_EQ(joined({"a", escape("<"), "c"}, "<br>").markup(), "a<br>&lt;<br>c");
}

TEST(ScriptJson, CannotEndItsElement) {
  const std::string text = "</script><!--<script>";
  const std::string script = script_json({{"text", text}});
  EXPECT_EQ(script.find('<'), std::string::npos);
  EXPECT_EQ(Json::parse(script)["text"], text);
  EXPECT_NO_THROW(script_json({{"not UTF-8", "\xff"}}));
}

TEST(Html, RoundsToSignificantDigitsWithoutPowersOfTenWherePossible) {
  EXPECT_EQ(significant(0.0017064).markup(), "0.001706");
  EXPECT_EQ(significant(9.99996).markup(), "10.00");
  EXPECT_EQ(significant(48213.4).markup(), "48213");
  EXPECT_EQ(significant(-3.5).markup(), "−3.500");
  EXPECT_EQ(significant(1.234e-7).markup(), "1.234·10<sup>−7</sup>");
  EXPECT_EQ(significant(0.0).markup(), "0");
  EXPECT_EQ(significant(std::nan("")).markup(), "–");
  EXPECT_EQ(percent(0.00002), "0.002\u00a0%");
  EXPECT_EQ(signed_percent(-0.0421), "−4.21\u00a0%");
  EXPECT_EQ(signed_percent(2.134), "+213\u00a0%");
  EXPECT_EQ(duration(85e-9), "85\u00a0ns");
  EXPECT_EQ(duration(1.2e-6), "1.2\u00a0µs");
  EXPECT_EQ(duration(14), "14\u00a0s");
}

}  // namespace
}  // namespace softfinger::report
