#include "meshes/io/read_surface.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>

#include "softfinger/input/errors.h"

namespace softfinger::meshes {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

/// A folder of its own for each test, removed afterwards.
class ReadSurface : public testing::Test {
 protected:
  ReadSurface() {
    folder_ = fs::temp_directory_path() / ("softfinger_read_surface_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  ~ReadSurface() override {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }

  std::string file(const std::string& name, const std::string& content) const {
    const fs::path path = folder_ / name;
    std::ofstream(path, std::ios::binary) << content;
    return path.string();
  }

  /// The error for this content: one line that names the file and what is allowed.
  std::string error(const std::string& name, const std::string& content, double unit = 1e-3) const {
    return error_at(file(name, content), unit);
  }
  static std::string error_at(const std::string& path, double unit = 1e-3) {
    try {
      read_surface(path, unit);
    } catch (const InputError& e) {
      const std::string line = e.what();
      EXPECT_EQ(line.find('\n'), std::string::npos) << line;
      EXPECT_EQ(line.find(path), 0u) << line;
      EXPECT_FALSE(e.allowed().empty()) << line;
      return line;
    }
    return "nothing was thrown";
  }

  fs::path folder_;
};

#define EXPECT_ERROR(part, ...)                            \
  do {                                                     \
    const std::string line = error(__VA_ARGS__);           \
    EXPECT_NE(line.find(part), std::string::npos) << line; \
  } while (false)

using Triangle = std::array<std::array<float, 3>, 3>;
const Triangle kOne{{{0, 0, 0}, {10, 0, 0}, {0, 10, 0}}};
const Triangle kTwo{{{10, 0, 0}, {10, 10, 0}, {0, 10, 0}}};

std::string binary_stl(const std::vector<Triangle>& triangles,
                       const std::string& title = "a mesh") {
  std::string bytes(84 + 50 * triangles.size(), '\0');
  std::copy(title.begin(), title.end(), bytes.begin());
  const auto count = static_cast<std::uint32_t>(triangles.size());
  std::memcpy(&bytes[80], &count, 4);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    std::memcpy(&bytes[84 + 50 * t + 12], triangles[t].data(), 36);
  return bytes;
}

std::string ascii_facet(const std::string& a, const std::string& b, const std::string& c) {
  return "facet normal 0 0 1\n outer loop\n  vertex " + a + "\n  vertex " + b + "\n  vertex " + c +
         "\n endloop\nendfacet\n";
}
const std::string kAscii = "solid part\n" + ascii_facet("0 0 0", "10 0 0", "0 10 0") +
                           ascii_facet("10 0 0", "1.0e1 +10 0", "0 10 0") + "endsolid part\n";
const std::string kObj =
    "# square\nmtllib missing.mtl\nv 0 0 0\nv 10 0 0\nv 10 10 0\nv 0 10 0\nf 1 2 3 4\n";

void expect_square(const SurfaceFile& read) {
  EXPECT_EQ(read.surface.vertices_m.size(), 4u);
  EXPECT_EQ(read.surface.triangles.size(), 2u);
  Vector3d area = Vector3d::Zero();
  for (const auto& [a, b, c] : read.surface.triangles)
    area += (read.surface.vertices_m[b] - read.surface.vertices_m[a])
                .cross(read.surface.vertices_m[c] - read.surface.vertices_m[a]) /
            2;
  // Single precision on its way in; counter-clockwise, so that the area points to +z.
  EXPECT_LT((area - Vector3d(0, 0, 1e-4)).norm(), 1e-4 * std::numeric_limits<float>::epsilon());
}

TEST_F(ReadSurface, ReadsBinaryAndAsciiStlAndObj) {
  expect_square(read_surface(file("a.stl", binary_stl({kOne, kTwo})), 1e-3));
  expect_square(read_surface(file("b.stl", kAscii), 1e-3));
  expect_square(read_surface(file("c.obj", kObj), 1e-3));
}

TEST_F(ReadSurface, GoesByTheContentNotByTheName) {
  expect_square(read_surface(file("a.obj", binary_stl({kOne, kTwo})), 1e-3));
  expect_square(read_surface(file("mesh", kObj), 1e-3));
  expect_square(read_surface(file("upper.STL", "SOLID" + kAscii.substr(5)), 1e-3));
}

TEST_F(ReadSurface, ReadsABinaryStlThatBeginsWithSolid) {
  expect_square(read_surface(file("a.stl", binary_stl({kOne, kTwo}, "solid exported")), 1e-3));
}

TEST_F(ReadSurface, ReadsABinaryStlWithNotesAtItsEnd) {
  expect_square(read_surface(file("a.stl", binary_stl({kOne, kTwo}) + "made by"), 1e-3));
}

TEST_F(ReadSurface, ReadsWindowsLineEndsAndRelativeObjIndices) {
  expect_square(read_surface(
      file("a.obj", "v 0 0 0\r\nv 10 0 0\r\nv 10 10 0\r\nv 0 10 0\r\nf -4 -3 -2 -1\r\n"), 1e-3));
  expect_square(read_surface(file("b.obj",
                                  "v 0 0 0\nv 10 0 0\nv 10 10 0\nv 0 10 0\nvn 0 0 1\nvt 0 0\n"
                                  "g one\nf 1/1/1 2/1/1 3//1\ng two\nf 1//1 3//1 4/1/1\n"),
                             1e-3));
}

TEST_F(ReadSurface, ReadsObjWithAnEncodingMarkAndContinuedLines) {
  const std::string text = "\xEF\xBB\xBFv 0 0 0\r\nv 1 0 \\\r\n0\r\nv 0 1 0\nf 1 \\\n2 \\\n3\n";
  EXPECT_EQ(read_surface(file("a.obj", text), 1e-3).surface.triangles.size(), 1u);
  try {
    read_surface(file("b.obj", text + "f 1 2 9\n"), 1e-3);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(error.where().find("b.obj:8"), std::string::npos) << error.what();
  }
}

TEST_F(ReadSurface, WeldsVerticesThatDifferInTheLastDigit) {
  Triangle two = kTwo;
  two[0][0] = std::nextafter(10.0f, 11.0f);
  expect_square(read_surface(file("a.stl", binary_stl({kOne, two})), 1e-3));
}

TEST_F(ReadSurface, ToleratesAndCountsDegenerateAndDuplicateTriangles) {
  const Triangle point{{{10, 0, 0}, {10, 0, 0}, {0, 10, 0}}};
  const Triangle needle{{{0, 0, 0}, {5, 0, 0}, {10, 0, 0}}};
  const Triangle turned{{kOne[1], kOne[2], kOne[0]}};
  const auto read =
      read_surface(file("a.stl", binary_stl({kOne, point, kTwo, needle, turned, kOne})), 1e-3);
  expect_square(read);
  EXPECT_EQ(read.degenerate_triangles, 2);
  EXPECT_EQ(read.duplicate_triangles, 2);
}

TEST_F(ReadSurface, TurnsAClosedSurfaceThatIsInsideOut) {
  const std::string tetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
  const auto right =
      read_surface(file("a.obj", tetrahedron + "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"), 1e-3);
  const auto wrong =
      read_surface(file("b.obj", tetrahedron + "f 1 2 3\nf 1 4 2\nf 2 4 3\nf 1 3 4\n"), 1e-3);
  EXPECT_FALSE(right.was_inside_out());
  EXPECT_TRUE(wrong.was_inside_out());
  for (const auto& read : {right, wrong}) {
    double volume = 0;
    for (const auto& [a, b, c] : read.surface.triangles)
      volume += read.surface.vertices_m[a].dot(
                    read.surface.vertices_m[b].cross(read.surface.vertices_m[c])) /
                6;
    EXPECT_GT(volume, 0);
  }
}

TEST_F(ReadSurface, TurnsTrianglesThatFaceTheOtherWayThanTheirNeighboursAndSaysSo) {
  const std::string tetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
  const auto one = read_surface(file("a.obj", tetrahedron + "f 1 3 2\nf 1 2 4\nf 2 4 3\nf 1 4 3\n"),
                                1e-3);  // the third
  EXPECT_EQ(one.turned_triangles, 1);
  EXPECT_EQ(repairs(one),
            "1 of 4 triangles faced the other way than their neighbours and were turned");
  // Three of four: the enclosed volume knows better than the majority.
  const auto three =
      read_surface(file("b.obj", tetrahedron + "f 1 2 3\nf 1 2 4\nf 2 4 3\nf 1 3 4\n"), 1e-3);
  EXPECT_EQ(three.turned_triangles, 3);
  // Two of five in a fan, which is open: the majority decides.
  const auto fan =
      read_surface(file("c.obj",
                        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv -1 1 0\nv -1 0 0\nv -1 -1 0\n"
                        "f 1 2 3\nf 1 4 3\nf 1 4 5\nf 1 6 5\nf 1 6 7\n"),
                   1e-3);
  EXPECT_EQ(fan.turned_triangles, 2);
  for (const auto& [a, b, c] : fan.surface.triangles) {
    const auto& v = fan.surface.vertices_m;
    EXPECT_GT((v[b] - v[a]).cross(v[c] - v[a]).z(), 0);
  }
  for (const auto& read : {one, three}) {
    double volume = 0;
    for (const auto& [a, b, c] : read.surface.triangles)
      volume += read.surface.vertices_m[a].dot(
                    read.surface.vertices_m[b].cross(read.surface.vertices_m[c])) /
                6;
    EXPECT_NEAR(volume, 1e-9 / 6, 1e-9 * std::numeric_limits<float>::epsilon());
  }
}

TEST_F(ReadSurface, SaysThatAMoebiusStripHasNoOutside) {
  // The shortest strip: five vertices, and each triangle joins three that follow each other.
  const auto strip = read_surface(file("a.obj",
                                       "v 0 0 0\nv 10 0 1\nv 0 10 2\nv 10 10 7\nv 4 5 20\n"
                                       "f 1 2 3\nf 2 3 4\nf 3 4 5\nf 4 5 1\nf 5 1 2\n"),
                                  1e-3);
  EXPECT_EQ(strip.turned_triangles, 0);
  EXPECT_NE(repairs(strip).find("cannot all face one side"), std::string::npos) << repairs(strip);
}

TEST_F(ReadSurface, NamesAVertexThatIsFarFromTheOthers) {
  const std::string square = "v 0 0 0\nv 10 0 0\nv 10 10 0\nv 0 10 0\n";
  const std::string allowed = ": allowed: at most 5000 of the file's units from the others";
  EXPECT_ERROR(".obj:5: vertex = (1e+30, 2, 3)" + allowed, "a.obj",
               square + "v 1e30 2 3\nf 1 2 3 4\nf 1 3 5\n");
  // In metres; what is as far as that in millimetres is a large finger.
  EXPECT_ERROR(".obj:5: vertex = (0, 0, -700): allowed: at most 5 of the file's units", "b.obj",
               "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 -700\nf 1 2 3 4\nf 1 3 5\n", 1.0);
  Triangle far = kTwo;
  far[1][2] = 1e30f;
  EXPECT_ERROR(".stl: vertex 2 of triangle 2 = (10, 10, 1e+30)" + allowed, "c.stl",
               binary_stl({kOne, far, kTwo}));
  EXPECT_ERROR(".stl:12: vertex = (10, 1e+09, 0)", "d.stl",
               "solid\n" + ascii_facet("0 0 0", "10 0 0", "0 10 0") +
                   ascii_facet("0 0 0", "10 1e9 0", "0 10 0") +
                   ascii_facet("10 0 0", "10 10 0", "0 10 0") + "endsolid\n");
  // One that no triangle uses is passed over, and welds none of the others together.
  expect_square(read_surface(file("e.obj", square + "v 1e30 2 3\nf 1 2 3 4\n"), 1e-3));
}

TEST_F(ReadSurface, NamesWhatIsNotAFile) {
  EXPECT_NE(error_at((folder_ / "none.stl").string()).find("missing"), std::string::npos);
  EXPECT_NE(error_at(folder_.string()).find("folder"), std::string::npos);
  EXPECT_ERROR("empty", "empty.stl", "");
  const std::string locked = file("locked.stl", kAscii);
  fs::permissions(locked, fs::perms::none);
  if (::geteuid() != 0) {  // root reads everything
    EXPECT_NE(error_at(locked).find("unreadable"), std::string::npos);
  }
}

TEST_F(ReadSurface, NeverWaitsForWhatIsNoRegularFile) {
  const std::string pipe = (folder_ / "pipe.stl").string();
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_NE(error_at(pipe).find("file = a pipe"), std::string::npos);
  EXPECT_NE(error_at("/dev/zero").find("file = a device"), std::string::npos);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string socket_path = (folder_ / "socket").string();
  socket_path.copy(address.sun_path, sizeof address.sun_path - 1);
  const int listener = socket(AF_UNIX, SOCK_STREAM, 0);
  ASSERT_EQ(bind(listener, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  EXPECT_NE(error_at(socket_path).find("file = a socket"), std::string::npos);
  close(listener);
}

TEST_F(ReadSurface, OpensNoFileThatAnotherOneNames) {
  // Whoever opened the pipe would wait here for ever: then the alarm ends the test.
  ASSERT_EQ(mkfifo((folder_ / "pipe.mtl").c_str(), 0600), 0);
  const std::string absolute = "mtllib " + (folder_ / "pipe.mtl").string() + "\n";
  const std::string square = kObj.substr(kObj.find("v 0"));
  alarm(20);
  for (const std::string& line :
       {absolute, std::string("mtllib pipe.mtl\nusemtl a\n"), "mtllib \\\n" + absolute.substr(7)})
    expect_square(read_surface(file("a.obj", line + square), 1e-3));
  alarm(0);
}

TEST_F(ReadSurface, RefusesWhatIsTooLarge) {
  const std::string large = file("large.stl", binary_stl({kOne}));
  fs::resize_file(large, kLargestSurface_bytes + 1);  // takes no room on the disk
  EXPECT_NE(error_at(large).find("file size = 1000000001"), std::string::npos);
  std::string many = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf";
  for (int corner = 0; corner < 10'001; ++corner) many += " 1";
  EXPECT_ERROR(".obj:4: face = 10001 corners: allowed: 3 to 10000", "many.obj", many + "\n");
}

TEST_F(ReadSurface, NamesWhatIsNotAMesh) {
  EXPECT_ERROR("not a mesh", "note.stl", "dear reader,\nthis is a letter\n");
  EXPECT_ERROR("not a mesh", "note.txt", "dear reader");
  EXPECT_ERROR("triangles", "note.obj", "dear reader");
  EXPECT_ERROR("not a mesh", "picture.png", std::string("\x89PNG\r\n\x1a\n\0\0\0\rIHDR", 16));
  std::string noise(1000, '\0');
  for (std::size_t i = 0; i < noise.size(); ++i) noise[i] = static_cast<char>(i * i * 31 + 7 * i);
  EXPECT_ERROR("mesh", "noise.stl", noise);
  EXPECT_ERROR("mesh", "noise.obj", noise);
  EXPECT_ERROR("mesh", "short.stl", std::string(10, '\1'));
}

TEST_F(ReadSurface, NamesWhatIsTruncated) {
  const std::string binary = binary_stl({kOne, kTwo});
  EXPECT_ERROR("184 bytes for the 2 triangles", "a.stl", binary.substr(0, 150));
  EXPECT_ERROR("truncated", "solid.stl", binary_stl({kOne, kTwo}, "solid x").substr(0, 150));
  for (std::size_t length = 1; length < kAscii.size(); length += 7) {
    const std::string line = error("cut.stl", kAscii.substr(0, length));
    if (kAscii.substr(0, length).find("endsolid") == std::string::npos) {
      EXPECT_NE(line, "nothing was thrown") << length;
    }
  }
  EXPECT_ERROR("endsolid", "b.stl", kAscii.substr(0, kAscii.size() - 15));
  EXPECT_ERROR(
      "triangle", "c.stl",
      "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nendloop\nendfacet\nendsolid\n");
}

TEST_F(ReadSurface, NamesCoordinatesThatAreNoFiniteNumbers) {
  for (float bad : {std::nanf(""), std::numeric_limits<float>::infinity()}) {
    Triangle two = kTwo;
    two[1][2] = bad;
    EXPECT_ERROR("coordinate of vertex 2 of triangle 2", "a.stl", binary_stl({kOne, two}));
  }
  for (const char* bad : {"nan", "inf", "-inf", "1e99", "ten", "1.0.0", ""}) {
    const std::string vertex = "0 " + std::string(bad);
    EXPECT_ERROR(".stl:6: vertex coordinate", "b.stl",
                 "solid\n"
                 "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex " +
                     vertex + "\nendloop\nendfacet\nendsolid\n");
    EXPECT_ERROR(".obj:2: vertex coordinate", "c.obj",
                 "v 0 0 0\nv " + vertex + "\nv 0 1 0\nf 1 2 3\n");
  }
}

TEST_F(ReadSurface, NamesObjIndicesOutOfRange) {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  EXPECT_ERROR(".obj:4: vertex index = 4", "a.obj", vertices + "f 1 2 4\n");
  EXPECT_ERROR(".obj:4: vertex index = 0", "b.obj", vertices + "f 0 1 2\n");
  EXPECT_ERROR(".obj:4: vertex index = -4", "c.obj", vertices + "f -4 -1 -2\n");
  EXPECT_ERROR(".obj:4: normal index = 1", "d.obj", vertices + "f 1//1 2//1 3//1\n");
  EXPECT_ERROR(".obj:4: texture index = 7", "e.obj", vertices + "f 1/7 2/7 3/7\n");
  EXPECT_ERROR(".obj:4: face corner = two", "f.obj", vertices + "f 1 two 3\n");
  EXPECT_ERROR(".obj:4: face corner", "g.obj", vertices + "f 1 2 99999999999999999999\n");
  EXPECT_ERROR(".obj:4: face = 2 corners", "h.obj", vertices + "f 1 2\n");
}

TEST_F(ReadSurface, NamesMeshesWithoutTriangles) {
  EXPECT_ERROR("triangles = 0", "a.stl", binary_stl({}));
  EXPECT_ERROR("triangles = 0", "b.stl", "solid empty\nendsolid empty\n");
  EXPECT_ERROR("triangles = 0", "c.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
  EXPECT_ERROR("1 degenerate", "d.stl", binary_stl({Triangle{}}));
}

TEST_F(ReadSurface, AsksForTheUnitWhereASizeIsImpossible) {
  EXPECT_ERROR("is the unit right?", "a.stl", kAscii, 1.0);   // a finger of 14 m
  EXPECT_ERROR("is the unit right?", "b.stl", kAscii, 1e-7);  // of 1.4 micrometres
  EXPECT_ERROR("unit", "c.stl", kAscii, 0.0);
  EXPECT_ERROR("unit", "d.stl", kAscii, std::nan(""));
}

TEST_F(ReadSurface, ReadsBackWhatItWrites) {
  const auto square = read_surface(file("a.obj", kObj), 1e-3);
  const std::string path = (folder_ / "out.stl").string();
  write_stl_mm(square.surface, path);
  expect_square(read_surface(path, 1e-3));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 2)
      << "no temporary file is left";
}

TEST_F(ReadSurface, WritingFollowsNoLinkThatSomeoneHasPutThere) {
  const auto square = read_surface(file("a.obj", kObj), 1e-3);
  const std::string victim = file("victim", "mine"), path = (folder_ / "out.stl").string();
  fs::create_symlink(victim, path + ".part" + std::to_string(::getpid()));
  write_stl_mm(square.surface, path);
  EXPECT_EQ(fs::file_size(victim), 4u);
  expect_square(read_surface(path, 1e-3));
}

TEST_F(ReadSurface, WritingLeavesNothingHalfWritten) {
  const auto square = read_surface(file("a.obj", kObj), 1e-3);
  EXPECT_THROW(write_stl_mm(square.surface, (folder_ / "none" / "out.stl").string()), InputError);

  // A full disk, as a process sees it: writes beyond the limit fail.
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit small{100, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  const std::string path = (folder_ / "out.stl").string();
  try {
    write_stl_mm(square.surface, path);
    ADD_FAILURE() << "a full disk went unnoticed";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("cannot be written"), std::string::npos) << e.what();
  }
  setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1);
}

TEST_F(ReadSurface, GuessesTheUnitThatMakesAFingerOfTheSurface) {
  // Both units are as far from 15 mm at sqrt(15 mm x 15 m) / m = 0.474.
  EXPECT_EQ(guessed_metres_per_unit(15), 1e-3);
  EXPECT_EQ(guessed_metres_per_unit(0.015), 1);
  EXPECT_EQ(guessed_metres_per_unit(0.476), 1e-3);
  EXPECT_EQ(guessed_metres_per_unit(0.472), 1);
  EXPECT_EQ(guessed_metres_per_unit(2000), 1e-3);
  // The middle one of 0.2, 0.02 and 0.3 is the width.
  const auto box = [&](double scale) {
    std::string text;
    for (int i = 0; i < 8; ++i)
      text += "v " + std::to_string(scale * 0.2 * (i & 1)) + " " +
              std::to_string(scale * 0.02 * (i >> 1 & 1)) + " " +
              std::to_string(scale * 0.3 * (i >> 2)) + "\n";
    return file("box.obj",
                text + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n");
  };
  const SurfaceFile metres = read_surface(box(1), std::nullopt);
  EXPECT_TRUE(metres.is_unit_guessed);
  EXPECT_EQ(metres.metres_per_unit, 1);
  EXPECT_NEAR(metres.width_m, 0.2, 1e-6);
  EXPECT_EQ(read_surface(box(10), std::nullopt).metres_per_unit, 1e-3);
  const SurfaceFile typed = read_surface(box(1), 1e-3);
  EXPECT_FALSE(typed.is_unit_guessed) << "what is typed wins";
  EXPECT_NEAR(typed.width_m, 0.2e-3, 1e-9);
}

}  // namespace
}  // namespace softfinger::meshes
