#include "comparisons/sweep/sweep_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "comparisons/input/case_table.h"
#include "comparisons/input/toml_path.h"
#include "comparisons/text/nearest_name.h"
#include "softfinger/input/errors.h"
#include "softfinger/input/hash.h"

namespace softfinger::sweep {
namespace fs = std::filesystem;
using input::find_entry;
using input::place_of;
using input::steps_of;
namespace {

/// The number that a key names; null when there is none.
toml::node* find_number(toml::table& root, const std::string& key) {
  toml::node* node = &root;
  const std::vector<std::string> steps = steps_of(key);
  for (const std::string& step : steps)
    if (node) node = find_entry(*node, step);
  return steps.empty() || !node || !node->is_number() ? nullptr : node;
}

/// All keys under a node that name a number.
void collect_keys(const toml::node& node, const std::string& path, std::vector<std::string>& keys) {
  if (node.is_number()) keys.push_back(path);
  if (const toml::table* table = node.as_table())
    for (const auto& [key, entry] : *table)
      collect_keys(entry, (path.empty() ? "" : path + ".") + std::string(key.str()), keys);
  if (const toml::array* array = node.as_array())
    for (std::size_t i = 0; i < array->size(); ++i)
      collect_keys(*array->get(i), fmt::format("{}[{}]", path, i), keys);
}

std::size_t count_of(const input::TomlReader& reader, const toml::node& node,
                     const std::string& field, std::size_t least) {
  const std::string allowed = fmt::format("a whole number from {} to {}", least, kMostSweptValues);
  const double value = reader.number(node, field, allowed);
  if (!(value >= double(least) && value <= double(kMostSweptValues)) || value != std::floor(value))
    reader.refuse(node, field, allowed);
  return std::size_t(value);
}

/// { from, to, steps } or { from, to, random, seed }, either with spacing = "log".
void read_range(const input::TomlReader& reader, const toml::table& table, SweptKey& swept) {
  const std::string& key = swept.key;
  reader.check_keys(table, key, {"from", "to", "steps", "spacing", "random", "seed"});
  const double from = reader.number(reader.required(table, key, "from"), "from", "a number");
  const double to = reader.number(reader.required(table, key, "to"), "to", "a number");
  if (const toml::node* spacing = table.get("spacing"))
    swept.log_spacing = reader.choice(*spacing, "spacing", {"linear", "log"}) == "log";
  if (swept.log_spacing && !(from > 0 && to > 0))
    reader.say(table, key + " with spacing = \"log\" needs from and to above 0");
  const auto between = [&](double part) {
    return swept.log_spacing ? from * std::pow(to / from, part) : from + (to - from) * part;
  };
  if (table.contains("steps") == table.contains("random"))
    reader.say(table, key + " needs exactly one of steps, random");
  if (const toml::node* steps = table.get("steps")) {
    if (const toml::node* seed = table.get("seed"))
      reader.refuse(*seed, "seed", "nothing here: it belongs to random");
    const std::size_t count = count_of(reader, *steps, "steps", 2);
    for (std::size_t i = 0; i < count; ++i)
      swept.values.push_back(i + 1 == count ? to : between(double(i) / double(count - 1)));
    return;
  }
  const std::size_t count = count_of(reader, *table.get("random"), "random", 1);
  std::uint64_t seed = 1;
  if (const toml::node* node = table.get("seed")) {
    const auto value = node->value<std::int64_t>();
    if (!node->is_integer() || !value || *value < 0)
      reader.refuse(*node, "seed", "a whole number >= 0");
    seed = std::uint64_t(*value);
  }
  // std::uniform_real_distribution would give different numbers with different standard libraries.
  // The key's name enters the seed, so that two keys with the same seed get different numbers.
  std::mt19937_64 generator(seed ^ softfinger::hash_of(key));
  for (std::size_t i = 0; i < count; ++i)
    swept.values.push_back(between(double(generator() >> 11) * 0x1p-53));
}

SweptKey read_key(const input::TomlReader& reader, const std::string& key, const toml::node& node) {
  SweptKey swept;
  swept.key = key;
  if (const toml::table* table = node.as_table()) {
    read_range(reader, *table, swept);
    return swept;
  }
  const std::string allowed =
      "a list of numbers, { from, to, steps } or { from, to, random, seed }, both with spacing = "
      "\"log\" or \"linear\"";
  const toml::array* list = node.as_array();
  if (!list || list->empty()) reader.refuse(node, key, allowed);
  if (list->size() > kMostSweptValues)
    reader.refuse(node, key, fmt::format("at most {} values", kMostSweptValues));
  for (const toml::node& entry : *list)
    swept.values.push_back(reader.number(entry, key, allowed, true));
  return swept;
}

bool is_whole(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double value) {
    return value == std::floor(value) && std::abs(value) < 1e15;
  });
}

/// An entry of [sweep], and where its key stands.
struct Entry {
  std::string key;
  const toml::node* node;
  toml::source_position place;
};

/// The keys in the order of the file: the library sorts keys by name.
std::vector<Entry> entries_in_order(const toml::table& sweep) {
  std::vector<Entry> entries;
  for (const auto& [key, node] : sweep)
    entries.push_back({std::string(key.str()), &node, key.source().begin});
  std::stable_sort(entries.begin(), entries.end(),
                   [](const Entry& left, const Entry& right) { return left.place < right.place; });
  return entries;
}

std::vector<std::string> read_models(const input::TomlReader& reader, const toml::node& node) {
  const toml::array* names = node.as_array();
  if (!names || names->empty()) reader.refuse(node, "models", "a list of model names");
  std::vector<std::string> models;
  for (const toml::node& name : *names) models.push_back(reader.text(name, "models"));
  return models;
}

/// One axis in place of those of the keys that `zip` lets change together.
void join_axes(const input::TomlReader& reader, const toml::node& zip,
               const std::vector<SweptKey>& keys, std::vector<std::vector<std::size_t>>& axes) {
  const std::string allowed = "a list of lists of swept keys: [[\"a\", \"b\"], ...]";
  const toml::array* groups = zip.as_array();
  if (!groups) reader.refuse(zip, "zip", allowed);
  for (const toml::node& group : *groups) {
    const toml::array* names = group.as_array();
    if (!names || names->size() < 2) reader.refuse(zip, "zip", allowed);
    std::vector<std::size_t> together;
    for (const toml::node& name : *names) {
      const std::string key = reader.text(name, "zip");
      const auto found = std::find_if(keys.begin(), keys.end(),
                                      [&](const SweptKey& swept) { return swept.key == key; });
      if (found == keys.end()) reader.refuse(name, "zip", "keys of [sweep]");
      const std::size_t index = std::size_t(found - keys.begin());
      const auto axis = std::find(axes.begin(), axes.end(), std::vector<std::size_t>{index});
      if (axis == axes.end()) reader.refuse(name, "zip", "each key once");
      axes.erase(axis);
      if (!together.empty() && found->values.size() != keys[together[0]].values.size())
        reader.say(name, fmt::format("zip pairs values one by one: \"{}\" has {}, \"{}\" has {}",
                                     keys[together[0]].key, keys[together[0]].values.size(), key,
                                     found->values.size()));
      together.push_back(index);
    }
    axes.push_back(together);
  }
  std::sort(axes.begin(), axes.end());
}

/// Makes the swept numbers floating-point ones where a value is none of the integers. The others
/// stay integers, because some keys, the level for one, must be.
void make_settable(toml::table& root, const std::vector<SweptKey>& keys) {
  for (const SweptKey& swept : keys) {
    toml::node& node = *find_number(root, swept.key);
    if (node.is_integer() && is_whole(swept.values)) continue;
    const double value = swept.values.front();
    const std::vector<std::string> steps = steps_of(swept.key);
    toml::node* parent = &root;
    for (std::size_t i = 0; i + 1 < steps.size(); ++i) parent = find_entry(*parent, steps[i]);
    if (toml::array* array = parent->as_array())
      array->replace(array->cbegin() + std::ptrdiff_t(place_of(steps.back())), value);
    else
      parent->as_table()->insert_or_assign(steps.back(), value);
  }
}

/// Checks the extreme values of a key now, so that a value out of range is not found hours later.
/// @returns the case with the last of them
input::Case try_extreme_values(const toml::table& root, const std::string& text,
                               const fs::path& path, const SweptKey& swept,
                               const std::string& where) {
  const std::vector<double>& values = swept.values;
  const auto [smallest, largest] = std::minmax_element(values.begin(), values.end());
  input::Case last;
  for (const double value : {values.front(), values.back(), *smallest, *largest}) {
    toml::table tried = root;
    toml::node& node = *find_number(tried, swept.key);
    if (node.is_integer())
      *node.as_integer() = std::int64_t(value);
    else
      *node.as_floating_point() = value;
    try {
      last = input::case_of(tried, text, path);
    } catch (const InputError& error) {
      throw InputError(where,
                       fmt::format("[sweep] \"{}\" = {}: {}", swept.key, value, error.field()),
                       error.value(), error.allowed());
    }
  }
  return last;
}

}  // namespace

std::string read_sweep_text(const fs::path& file) { return input::read_typed_text(file); }

/// The parsed file: the table of the case, with one number in place of each swept key's values.
struct Sweep::File {
  std::string text;
  fs::path path;
  toml::table root;
};

struct Sweep::Cases::Table {
  toml::table root;
  std::vector<toml::node*> numbers;  // of each key
};

Sweep::~Sweep() = default;

Sweep::Sweep(const std::string& typed_text, const fs::path& path, const input::Settings& settings)
    : file_(std::make_unique<File>()) {
  file_->path = path;
  toml::table& root = file_->root = input::parse_toml(typed_text, path.string(), settings);
  const std::string& text = file_->text = input::text_of(root, typed_text, settings);
  const input::TomlReader reader(path.string());
  reader.required_table(root, "sweep");
  // Moved, because a copy would lose the line numbers.
  const toml::table sweep = std::move(*root["sweep"].as_table());
  root.erase("sweep");
  base_ = input::case_of(root, text, path);
  input::require_coulomb(base_, "sweep");
  input::refuse_times(base_, "softfinger sweep");

  const std::vector<Entry> entries = entries_in_order(sweep);
  std::vector<std::string> known;
  collect_keys(root, "", known);
  known.push_back("contact.load_N");
  for (const Entry& entry : entries) {
    if (entry.key == "fem") {
      if (!entry.node->is_boolean()) reader.refuse(*entry.node, "fem", "true or false");
      fem_ = entry.node->as_boolean()->get();
    } else if (entry.key == "models") {
      models_ = read_models(reader, *entry.node);
    } else if (entry.key != "zip") {
      // A list of loads is replaced by a single number that can be swept.
      if (entry.key == "contact.load_N")
        root["contact"].as_table()->insert_or_assign("load_N", base_.loads_N.front());
      if (!find_number(root, entry.key))
        throw InputError(fmt::format("{}:{}", path.string(), entry.place.line),
                         fmt::format("[sweep] \"{}\" is not a number of this case{}", entry.key,
                                     text::did_you_mean(entry.key, known)),
                         "", text::joined(known));
      keys_.push_back(read_key(reader, entry.key, *entry.node));
      axes_.push_back({keys_.size() - 1});
    }
  }
  if (keys_.empty()) reader.say(sweep, "[sweep] names no number of the case");
  if (const toml::node* zip = sweep.get("zip")) join_axes(reader, *zip, keys_, axes_);

  const std::size_t most = fem_ ? kMostSweepFemJobs : kMostSweepRows;
  const std::string allowed =
      fmt::format("at most {} rows{}", most, fem_ ? " with fem = true" : "");
  for (const auto& axis : axes_) {
    points_ *= keys_[axis[0]].values.size();
    if (points_ > most)
      throw InputError(path.string(), "[sweep]", "more than " + std::to_string(points_) + " points",
                       allowed);
  }
  make_settable(root, keys_);
  for (const SweptKey& swept : keys_) {
    const auto entry = std::find_if(entries.begin(), entries.end(),
                                    [&](const Entry& one) { return one.key == swept.key; });
    base_ = try_extreme_values(root, text, path, swept, reader.where(*entry->node));
  }
  Cases first(*this);
  try {
    base_ = first.at(0);
  } catch (const InputError&) {
    // These values do not fit together: the row of this point will say so.
  }
  if (rows() > most)
    throw InputError(path.string(), "[sweep]", fmt::format("{} rows", rows()), allowed);
}

const std::string& Sweep::text() const { return file_->text; }

void Sweep::values_at(std::size_t point, std::vector<double>& values) const {
  values.resize(keys_.size());
  for (auto axis = axes_.rbegin(); axis != axes_.rend(); ++axis) {
    const std::size_t count = keys_[axis->front()].values.size();
    for (const std::size_t key : *axis) values[key] = keys_[key].values[point % count];
    point /= count;
  }
}

Sweep::Cases::Cases(const Sweep& sweep) : sweep_(sweep), table_(std::make_unique<Table>()) {
  table_->root = sweep.file_->root;
  for (const SweptKey& swept : sweep.keys_)
    table_->numbers.push_back(find_number(table_->root, swept.key));
}

Sweep::Cases::~Cases() = default;

input::Case Sweep::Cases::at(std::size_t point) {
  sweep_.values_at(point, values_);
  for (std::size_t key = 0; key < values_.size(); ++key) {
    toml::node& node = *table_->numbers[key];
    if (node.is_integer())
      *node.as_integer() = std::int64_t(values_[key]);
    else
      *node.as_floating_point() = values_[key];
  }
  return input::case_of(table_->root, sweep_.file_->text, sweep_.file_->path);
}

}  // namespace softfinger::sweep
