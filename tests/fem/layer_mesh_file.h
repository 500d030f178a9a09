#pragma once

#include <cmath>
#include <fstream>
#include <iomanip>
#include <string>
#include <vector>

#include "meshes/generation/layer_block.h"

namespace softfinger::tests {

/// Writes a flat block as a user's mesher would, in mm and gmsh's format 2.2, with one thing or
/// another wrong on demand.
struct LayerMeshFile {
  meshes::LayerBlock block;                     ///< a quarter, in mm
  std::vector<std::string> layers = {"layer"};  ///< volumes of the block's sublayers
  std::string contact = "contact", core = "core";
  double contact_reach_mm = INFINITY;  ///< of the surface "contact" along x and y
  int inverted = -1;                   ///< a cell whose top and bottom are exchanged
  int split = -1;                      ///< a cell with a tetrahedron in its place

  void write(const std::string& path) const {
    const meshes::HexahedralMesh quarter = meshes::mesh_layer_block(block);
    std::ofstream file(path);
    file << std::setprecision(17) << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n"
         << 2 + layers.size() << "\n2 1 \"" << contact << "\"\n2 2 \"" << core << "\"\n";
    for (std::size_t i = 0; i < layers.size(); ++i)
      file << "3 " << 3 + i << " \"" << layers[i] << "\"\n";
    file << "$EndPhysicalNames\n$Nodes\n" << 4 * quarter.vertices.size() << '\n';
    // Vertices on the planes between the quarters have to be shared.
    const auto vertices = static_cast<int>(quarter.vertices.size());
    const double signs[4][2] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};
    const auto node = [&](int image, int vertex) {
      const auto& at = quarter.vertices[static_cast<std::size_t>(vertex)];
      const int across_x[] = {0, 0, 3, 3}, across_y[] = {0, 1, 1, 0};
      if (std::abs(at.x()) < 1e-9) image = across_x[image];
      if (std::abs(at.y()) < 1e-9) image = across_y[image];
      return 1 + image * vertices + vertex;
    };
    for (int image = 0; image < 4; ++image)
      for (int v = 0; v < vertices; ++v) {
        const auto& at = quarter.vertices[static_cast<std::size_t>(v)];
        file << 1 + image * vertices + v << ' ' << signs[image][0] * at.x() << ' '
             << signs[image][1] * at.y() << ' ' << at.z() << '\n';
      }
    file << "$EndNodes\n$Elements\n";
    double thickness = 0;
    for (const auto& sublayer : block.sublayers) thickness += sublayer.thickness;
    std::string elements;
    int count = 0;
    const auto add = [&](int type, int group, const std::vector<int>& nodes) {
      elements += std::to_string(++count) + " " + std::to_string(type) + " 2 " +
                  std::to_string(group) + " " + std::to_string(group);
      for (const int n : nodes) elements += " " + std::to_string(n);
      elements += '\n';
    };
    for (int image = 0; image < 4; ++image)
      for (std::size_t c = 0; c < quarter.cells.size(); ++c) {
        const auto& cell = quarter.cells[c];
        const int volume = 3 + quarter.region[c];
        std::vector<int> bottom, top;
        double z_top = -1e9, z_bottom = 1e9, reach = 0;
        for (std::size_t i = 0; i < 4; ++i) {
          // A mirror image lists its faces clockwise.
          const std::size_t corner = image % 2 == 0 ? i : (4 - i) % 4;
          bottom.push_back(node(image, cell[corner]));
          top.push_back(node(image, cell[corner + 4]));
          const auto& above = quarter.vertices[static_cast<std::size_t>(cell[corner + 4])];
          z_top = std::max(z_top, above.z());
          z_bottom =
              std::min(z_bottom, quarter.vertices[static_cast<std::size_t>(cell[corner])].z());
          reach = std::max({reach, above.x(), above.y()});
        }
        if (image == 0 && static_cast<int>(c) == inverted) std::swap(bottom, top);
        if (image == 0 && static_cast<int>(c) == split) {
          add(4, volume, {bottom[0], bottom[1], bottom[2], top[0]});
        } else {
          std::vector<int> all = bottom;
          all.insert(all.end(), top.begin(), top.end());
          add(5, volume, all);
        }
        if (std::abs(z_top) < 1e-9 && reach <= contact_reach_mm) add(3, 1, top);
        if (std::abs(z_bottom + thickness) < 1e-9) add(3, 2, bottom);
      }
    file << count << '\n' << elements << "$EndElements\n";
  }
};

}  // namespace softfinger::tests
