#pragma once

#include <filesystem>
#include <string>

#include "softfinger/dynamics/contacts/contact_lcp.h"

/// Contact problems as text files, one problem each: the line "softlcp 1", then keys, each with its
/// values on one line and numbers separated by blanks.
///
///   nc, u, nb            contacts, friction vertices per contact, bodies
///   mu, en               count nc and the values; e_n in m
///   V                    count 3 u and the values, column by column
///   minv                 count 6 nb and the values: 1/mass three times, 1/inertia about three axes
///   J                    count, then as many lines "row column value"; 4 nc x 6 nb
///   q4                   count 4 nc and the values: velocity without contact impulses, m/s and
///   rad/s
///
/// Each of these keys once, nc and nb before J. At most 1000 contacts, 1024 vertices, 100000 bodies
/// and 64 MiB. Other keys (class, tag, note, a reference solution) are skipped.
namespace softfinger::input {

/// Reads a problem. Its Delassus matrix is W = J diag(minv) J^T, from the keys `J` and `minv`.
/// @param file  "-": standard input
/// @throws InputError naming file, line and key
ContactLcp read_recorded_contacts(const std::filesystem::path& file);

/// Reads the problem from a text in memory; `file` is used in messages.
ContactLcp parse_recorded_contacts(const std::string& text, const std::filesystem::path& file);

/// Writes a problem with these friction vertices. The file format knows facets only, so that
/// problems with an exact friction law are written with facets too. Joints make the mass matrix
/// non-diagonal, which the format cannot express. Therefore J is a factor of W with minv = 1: W is
/// the same up to rounding, but the columns of J do not belong to bodies.
void write_recorded_contacts(const ContactLcp& problem, const Eigen::Matrix3Xd& vertices,
                             const std::string& note, const std::filesystem::path& path);

}  // namespace softfinger::input
