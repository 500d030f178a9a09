#pragma once

#include <random>
#include <string>
#include <string_view>
#include <vector>

/// Readers of what comes from outside, each as a function of bytes. libFuzzer drives them
/// (libfuzzer_entry.cc), and an ordinary test replays what it once found (replay.cc).
namespace softfinger::fuzz {

struct Target {
  const char* name;
  /// Reads the bytes. Returns whether they were accepted; a refusal in words, InputError, is as
  /// good. Whatever else is thrown is a finding, like a crash.
  bool (*read)(std::string_view bytes);
  /// Valid inputs to start from.
  std::vector<std::string> (*seeds)();
  /// Valid inputs by a grammar, endlessly many, where single bytes changed in the seeds do not get
  /// far; null: none.
  std::string (*random)(std::mt19937& generator);
  bool is_text;  ///< worth changing by lines and words, not only by bytes
};

extern const Target case_toml, scene_toml, sweep_toml, surface_stl, surface_obj, layer_msh,
    recorded_contacts, fem_problem, stored_result, error_atlas, experiment_toml, measurements,
    mask_png, mesh_3mf, mesh_assimp, robot_import, robot_xml, typed_numbers;

std::vector<Target> all_targets();

/// The text with a line or a number changed, moved, repeated or left out.
std::string change_text(std::string_view text, std::mt19937& generator);

/// The files of a folder of the source tree.
std::vector<std::string> texts_of(const std::string& folder, const std::string& extension);

}  // namespace softfinger::fuzz
