#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "comparisons/exporting/xml_text.h"

namespace softfinger::exporting {

/// Reads the text of a file.
using TextReader = std::function<std::string(const std::filesystem::path&)>;

/// A robot's file with those that it includes. MJCF includes by `<include file="..."/>`: the name
/// is looked for in the folder of the model, then in that of the file that includes. A file that
/// is not there stays an element of the tree.
/// @param path  of the model; empty: standard input, whose inclusions are not followed
/// @throws InputError as XmlFile, for a file that is included twice, for more than 200 of them, and
/// for more than 20 MB together
std::unique_ptr<XmlFile> read_with_included_files(const std::string& text, const std::string& where,
                                                  const std::filesystem::path& path,
                                                  const TextReader& read);

}  // namespace softfinger::exporting
