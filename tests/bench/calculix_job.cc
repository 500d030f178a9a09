#include "tests/bench/calculix_job.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace softfinger::bench {
namespace {

/// Coordinates of the quarter's lattice: fine to 1.25 a, then growing to a + 6; down to -1.
struct Lattice {
  std::vector<double> across, depth, indenter;

  explicit Lattice(const CalculixContact& contact) {
    const double cell = contact.a / contact.elements, end = contact.a + 6;
    for (int i = 0; i <= contact.elements * 5 / 4; ++i) across.push_back(i * cell);
    for (double step = 1.5 * cell; across.back() < end; step *= 1.5)
      across.push_back(std::min(across.back() + step, end));
    depth.push_back(0);
    for (double step = cell; depth.back() > -1; step *= 1.25)
      depth.push_back(std::max(depth.back() - step, -1.0));
    for (const double x : across)
      if (x <= 1.5 * contact.a) indenter.push_back(x);
  }
};

/// A block of nodes and elements, numbered from `first_node`: x fastest, then y, then level.
struct Block {
  long first_node, count, levels;

  long node(long i, long j, long level) const {
    return first_node + i + count * (j + count * level);
  }
  long nodes() const { return count * count * levels; }

  /// Elements of one slab, `bottom` and `top` its levels; `written`: number, column, row of each.
  void write(std::ostream& out, long bottom, long top, long& element,
             std::vector<std::array<long, 3>>& written) const {
    for (long j = 0; j + 1 < count; ++j)
      for (long i = 0; i + 1 < count; ++i) {
        out << ++element;
        for (const long level : {bottom, top})
          out << ',' << node(i, j, level) << ',' << node(i + 1, j, level) << ','
              << node(i + 1, j + 1, level) << ',' << node(i, j + 1, level);
        out << '\n';
        written.push_back({element, i, j});
      }
  }
};

void write_input(const CalculixContact& contact, std::ostream& out) {
  const Lattice lattice(contact);
  const Block layer{1, static_cast<long>(lattice.across.size()),
                    static_cast<long>(lattice.depth.size())};
  const Block indenter{1 + layer.nodes(), static_cast<long>(lattice.indenter.size()), 2};
  const long reference = indenter.first_node + indenter.nodes(), rotation = reference + 1;
  constexpr double thickness = 0.2;  // of the indenter: it is rigid, any value will do
  out.precision(12);
  out << "*NODE\n";
  long number = 0;
  for (const double z : lattice.depth)
    for (const double y : lattice.across)
      for (const double x : lattice.across)
        out << ++number << ',' << x << ',' << y << ',' << z << '\n';
  for (const double z : {0.0, thickness})
    for (const double y : lattice.indenter)
      for (const double x : lattice.indenter)
        out << ++number << ',' << x << ',' << y << ',' << (x * x + y * y) / (2 * contact.radius) + z
            << '\n';
  for (const long node : {reference, rotation}) out << node << ",0,0,0.5\n";

  long element = 0;
  std::vector<std::array<long, 3>> surface, lower, face;
  out << "*ELEMENT,TYPE=C3D8I,ELSET=LAYER\n";
  for (long level = 0; level + 1 < layer.levels; ++level)
    layer.write(out, level + 1, level, element, level == 0 ? surface : lower);
  out << "*ELEMENT,TYPE=C3D8,ELSET=INDENTER\n";
  indenter.write(out, 0, 1, element, face);
  out << "*MATERIAL,NAME=ELASTIC\n*ELASTIC\n1," << contact.poisson_ratio
      << "\n*SOLID SECTION,ELSET=LAYER,MATERIAL=ELASTIC\n"
         "*SOLID SECTION,ELSET=INDENTER,MATERIAL=ELASTIC\n";
  const auto write_set = [&](const char* name, auto belongs) {
    out << "*NSET,NSET=" << name << '\n';
    for (long level = 0; level < layer.levels; ++level)
      for (long j = 0; j < layer.count; ++j)
        for (long i = 0; i < layer.count; ++i)
          if (belongs(i, j, level)) out << layer.node(i, j, level) << ",\n";
  };
  const long base = layer.levels - 1;
  write_set("BASE", [&](long, long, long level) { return level == base; });
  write_set("MIRROR_X", [&](long i, long, long level) { return i == 0 && level < base; });
  write_set("MIRROR_Y", [&](long, long j, long level) { return j == 0 && level < base; });
  out << "*NSET,NSET=INDENTER,GENERATE\n"
      << indenter.first_node << ',' << reference - 1 << '\n'
      << "*RIGID BODY,NSET=INDENTER,REF NODE=" << reference << ",ROT NODE=" << rotation << '\n'
      << "*SURFACE,NAME=TOP,TYPE=ELEMENT\n";
  const double touchable = 1.3 * contact.a;
  for (const auto& [number_of, i, j] : surface)
    if (lattice.across[static_cast<std::size_t>(i + 1)] <= touchable &&
        lattice.across[static_cast<std::size_t>(j + 1)] <= touchable)
      out << number_of << ",S2\n";
  out << "*SURFACE,NAME=FACE,TYPE=ELEMENT\n";
  for (const auto& cell : face) out << cell[0] << ",S1\n";
  out << "*SURFACE INTERACTION,NAME=CONTACT\n*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR\n"
      << contact.contact_stiffness
      << ",1e-6\n*CONTACT PAIR,INTERACTION=CONTACT,TYPE=SURFACE TO SURFACE\nTOP,FACE\n"
         "*BOUNDARY\nBASE,1,3\nMIRROR_X,1,1\nMIRROR_Y,2,2\n"
      << reference << ",1,2\n"
      << rotation << ",1,3\n*STEP,NLGEOM=NO,INC=100\n*STATIC\n0.25,1\n*BOUNDARY\n"
      << reference << ",3,3," << -contact.approach
      << "\n*NODE PRINT,NSET=BASE,TOTALS=ONLY\nRF\n*END STEP\n";
}

}  // namespace

bool calculix_is_there() { return std::system("command -v ccx > /dev/null 2>&1") == 0; }

double load_by_calculix(const CalculixContact& contact, const std::filesystem::path& folder) {
  {
    std::ofstream input(folder / "contact.inp");
    write_input(contact, input);
    if (!input) throw std::runtime_error("cannot write " + folder.string());
  }
  const std::string command =
      "cd '" + folder.string() + "' && OMP_NUM_THREADS=1 ccx contact > ccx.log 2>&1";
  if (std::system(command.c_str()) != 0) throw std::runtime_error("ccx failed: see its ccx.log");
  std::ifstream results(folder / "contact.dat");
  double x = 0, y = 0, z = 0;
  bool found = false;
  for (std::string line; std::getline(results, line);)
    if (line.find("total force") != std::string::npos) found = bool(results >> x >> y >> z);
  if (!found) throw std::runtime_error("ccx wrote no forces");
  return 4 * z;
}

long unknowns_of(const CalculixContact& contact) {
  const Lattice lattice(contact);
  return 3 *
         static_cast<long>(lattice.across.size() * lattice.across.size() * lattice.depth.size());
}

}  // namespace softfinger::bench
