#pragma once

#include <fmt/format.h>
#include <zlib.h>

#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "softfinger/input/triangle_surface.h"

/// Small mesh files of several formats, written by hand. Coordinates are single precision, as
/// STL has them, and are written with all their digits.
namespace softfinger::tests {

/// A surface of a file, and its place there.
struct FilePart {
  std::string name;
  TriangleSurface surface;  ///< in the file's unit
  Eigen::Affine3d place = Eigen::Affine3d::Identity();
};

inline void append_number(std::string& bytes, std::uint64_t value, int count) {
  // Zeros follow a number that is shorter than its field.
  for (int i = 0; i < count; ++i, value >>= 8) bytes += char(value & 0xFF);
}

/// A ZIP archive whose files are stored as they are, or deflated.
inline std::string zip_of(const std::vector<std::pair<std::string, std::string>>& files,
                          bool is_deflated = false) {
  std::string bytes, directory;
  for (const auto& [name, content] : files) {
    std::string packed = content;
    if (is_deflated) {
      uLongf size = compressBound(uLong(content.size()));
      std::string stream(size, '\0');
      compress(reinterpret_cast<Bytef*>(stream.data()), &size,
               reinterpret_cast<const Bytef*>(content.data()), uLong(content.size()));
      packed = stream.substr(2, size - 6);  // without zlib's own head and sum
    }
    std::string entry;
    append_number(entry, 20, 2);
    append_number(entry, 0, 2);
    append_number(entry, is_deflated ? 8 : 0, 2);
    append_number(entry, 0, 4);
    append_number(
        entry, crc32(0, reinterpret_cast<const Bytef*>(content.data()), uInt(content.size())), 4);
    append_number(entry, packed.size(), 4);
    append_number(entry, content.size(), 4);
    append_number(entry, name.size(), 2);
    append_number(entry, 0, 2);
    append_number(directory, 0x02014b50, 4);
    append_number(directory, 20, 2);
    directory += entry;
    append_number(directory, 0, 10);
    append_number(directory, bytes.size(), 4);
    directory += name;
    append_number(bytes, 0x04034b50, 4);
    bytes += entry + name + packed;
  }
  const std::size_t begin = bytes.size();
  bytes += directory;
  append_number(bytes, 0x06054b50, 4);
  append_number(bytes, 0, 4);
  append_number(bytes, files.size(), 2);
  append_number(bytes, files.size(), 2);
  append_number(bytes, directory.size(), 4);
  append_number(bytes, begin, 4);
  append_number(bytes, 0, 2);
  return bytes;
}

/// @param rows  true: a transform's rows one after the other (DAE); false: its columns (glTF)
inline std::string sixteen_numbers(const Eigen::Affine3d& place, bool rows, const char* separator) {
  std::string text;
  for (int i = 0; i < 16; ++i)
    text += fmt::format("{}{}", i > 0 ? separator : "",
                        rows ? place.matrix()(i / 4, i % 4) : place.matrix()(i % 4, i / 4));
  return text;
}

/// @param unit     the attribute's value; empty: no unit
/// @param up_axis  empty: none
inline std::string dae_of(const std::vector<FilePart>& parts, const std::string& unit,
                          const std::string& up_axis) {
  std::string text =
      "<?xml version=\"1.0\"?>\n<COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" "
      "version=\"1.4.1\"><asset>";
  if (!unit.empty()) text += "<unit name=\"own\" meter=\"" + unit + "\"/>";
  if (!up_axis.empty()) text += "<up_axis>" + up_axis + "</up_axis>";
  text += "</asset>\n<library_geometries>\n";
  for (const FilePart& part : parts) {
    text += fmt::format(
        "<geometry id=\"{0}_id\" name=\"{0}\"><mesh><source id=\"{0}_at\"><float_array "
        "id=\"{0}_array\" count=\"{1}\">",
        part.name, 3 * part.surface.vertices_m.size());
    for (const Eigen::Vector3d& v : part.surface.vertices_m)
      text += fmt::format("{} {} {}\n", float(v.x()), float(v.y()), float(v.z()));
    text += fmt::format(
        "</float_array><technique_common><accessor source=\"#{0}_array\" count=\"{1}\" "
        "stride=\"3\">"
        "<param name=\"X\" type=\"float\"/><param name=\"Y\" type=\"float\"/><param name=\"Z\" "
        "type=\"float\"/></accessor></technique_common></source><vertices id=\"{0}_vertices\">"
        "<input semantic=\"POSITION\" source=\"#{0}_at\"/></vertices><triangles "
        "count=\"{2}\"><input "
        "semantic=\"VERTEX\" source=\"#{0}_vertices\" offset=\"0\"/><p>",
        part.name, part.surface.vertices_m.size(), part.surface.triangles.size());
    for (const auto& t : part.surface.triangles)
      text += fmt::format("{} {} {}\n", t[0], t[1], t[2]);
    text += "</p></triangles></mesh></geometry>\n";
  }
  text += "</library_geometries>\n<library_visual_scenes><visual_scene id=\"scene\">\n";
  for (const FilePart& part : parts)
    text += fmt::format(
        "<node id=\"{0}_node\" name=\"{0}\"><matrix>{1}</matrix><instance_geometry "
        "url=\"#{0}_id\"/></node>\n",
        part.name, sixteen_numbers(part.place, true, " "));
  return text +
         "</visual_scene></library_visual_scenes>\n<scene><instance_visual_scene "
         "url=\"#scene\"/></scene></COLLADA>\n";
}

struct Gltf {
  std::string json, buffer;
};

/// @param uri  of the buffer, as it stands in the JSON; empty: the buffer of a GLB file
inline Gltf gltf_of(const std::vector<FilePart>& parts, const std::string& uri) {
  Gltf gltf;
  std::string views, accessors, meshes, nodes, all;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const TriangleSurface& surface = parts[i].surface;
    const std::size_t at = gltf.buffer.size();
    Eigen::Vector3f low = Eigen::Vector3f::Constant(1e9f), high = -low;
    for (const Eigen::Vector3d& v : surface.vertices_m) {
      const Eigen::Vector3f single = v.cast<float>();
      low = low.cwiseMin(single);
      high = high.cwiseMax(single);
      gltf.buffer.append(reinterpret_cast<const char*>(single.data()), 12);
    }
    const std::size_t indices = gltf.buffer.size();
    for (const auto& t : surface.triangles)
      for (const int v : t) append_number(gltf.buffer, std::uint64_t(v), 4);
    const char* comma = i > 0 ? "," : "";
    views += fmt::format(
        "{}{{\"buffer\":0,\"byteOffset\":{},\"byteLength\":{}}},{{\"buffer\":0,\"byteOffset\":{},"
        "\"byteLength\":{}}}",
        comma, at, indices - at, indices, gltf.buffer.size() - indices);
    accessors += fmt::format(
        "{}{{\"bufferView\":{},\"componentType\":5126,\"count\":{},\"type\":\"VEC3\",\"min\":[{},{}"
        ",{}"
        "],\"max\":[{},{},{}]}},{{\"bufferView\":{},\"componentType\":5125,\"count\":{},\"type\":"
        "\"SCALAR\"}}",
        comma, 2 * i, surface.vertices_m.size(), low.x(), low.y(), low.z(), high.x(), high.y(),
        high.z(), 2 * i + 1, 3 * surface.triangles.size());
    meshes += fmt::format(
        "{}{{\"name\":\"{}\",\"primitives\":[{{\"attributes\":{{\"POSITION\":{}}},\"indices\":{}}}]"
        "}}",
        comma, parts[i].name, 2 * i, 2 * i + 1);
    nodes += fmt::format("{}{{\"name\":\"{}\",\"mesh\":{},\"matrix\":[{}]}}", comma, parts[i].name,
                         i, sixteen_numbers(parts[i].place, false, ","));
    all += fmt::format("{}{}", comma, i);
  }
  gltf.json = fmt::format(
      "{{\"asset\":{{\"version\":\"2.0\"}},\"scene\":0,\"scenes\":[{{\"nodes\":[{}]}}],\n\"nodes\":"
      "[{}"
      "],\n\"meshes\":[{}],\n\"accessors\":[{}],\n\"bufferViews\":[{}],\n\"buffers\":[{{{}"
      "\"byteLength\""
      ":{}}}]}}",
      all, nodes, meshes, accessors, views, uri.empty() ? "" : "\"uri\":\"" + uri + "\",",
      gltf.buffer.size());
  return gltf;
}

inline std::string glb_of(const std::vector<FilePart>& parts) {
  Gltf gltf = gltf_of(parts, "");
  while (gltf.json.size() % 4 != 0) gltf.json += ' ';
  std::string bytes = "glTF";
  append_number(bytes, 2, 4);
  append_number(bytes, 28 + gltf.json.size() + gltf.buffer.size(), 4);
  append_number(bytes, gltf.json.size(), 4);
  bytes += "JSON" + gltf.json;
  append_number(bytes, gltf.buffer.size(), 4);
  return bytes + std::string("BIN\0", 4) + gltf.buffer;
}

/// @param is_binary  little endian
inline std::string ply_of(const TriangleSurface& surface, bool is_binary) {
  std::string text = fmt::format(
      "ply\nformat {} 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float "
      "z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
      is_binary ? "binary_little_endian" : "ascii", surface.vertices_m.size(),
      surface.triangles.size());
  for (const Eigen::Vector3d& v : surface.vertices_m) {
    const Eigen::Vector3f single = v.cast<float>();
    if (is_binary)
      text.append(reinterpret_cast<const char*>(single.data()), 12);
    else
      text += fmt::format("{} {} {}\n", single.x(), single.y(), single.z());
  }
  for (const auto& t : surface.triangles) {
    if (is_binary) {
      text += char(3);
      for (const int v : t) append_number(text, std::uint64_t(v), 4);
    } else {
      text += fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
    }
  }
  return text;
}

/// The model of a 3MF file.
/// @param unit  empty: no attribute, which means millimetres
inline std::string model_of(const std::vector<FilePart>& parts, const std::string& unit) {
  std::string objects, items;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    objects += fmt::format("<object id=\"{}\" name=\"{}\" type=\"model\"><mesh><vertices>\n", i + 1,
                           parts[i].name);
    for (const Eigen::Vector3d& v : parts[i].surface.vertices_m)
      objects += fmt::format("<vertex x=\"{}\" y=\"{}\" z=\"{}\"/>\n", float(v.x()), float(v.y()),
                             float(v.z()));
    objects += "</vertices><triangles>\n";
    for (const auto& t : parts[i].surface.triangles)
      objects += fmt::format("<triangle v1=\"{}\" v2=\"{}\" v3=\"{}\"/>\n", t[0], t[1], t[2]);
    objects += "</triangles></mesh></object>\n";
    const Eigen::Matrix4d& m = parts[i].place.matrix();
    std::string place;
    for (int column = 0; column < 4; ++column)
      for (int row = 0; row < 3; ++row)
        place += fmt::format("{}{}", place.empty() ? "" : " ", m(row, column));
    items += fmt::format("<item objectid=\"{}\" transform=\"{}\"/>\n", i + 1, place);
  }
  return fmt::format(
      "<?xml version=\"1.0\"?>\n<model{} "
      "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n<resources>\n{}"
      "</resources>\n<build>\n{}</build>\n</model>\n",
      unit.empty() ? "" : " unit=\"" + unit + "\"", objects, items);
}

inline std::string threemf_of(const std::vector<FilePart>& parts, const std::string& unit,
                              bool is_deflated = false) {
  return zip_of({{"[Content_Types].xml", "<Types/>"},
                 {"_rels/.rels",
                  "<Relationships><Relationship Target=\"/3D/own.model\" "
                  "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/>"
                  "</Relationships>"},
                 {"3D/own.model", model_of(parts, unit)}},
                is_deflated);
}

}  // namespace softfinger::tests
