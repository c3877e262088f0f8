#include "carom/geometry/mesh_file.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstring>

#include "carom/geometry/mass_properties.h"

namespace carom::geometry::mesh_file_test {
namespace {

const char* cube_obj = R"(# a unit cube of quads
o cube
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 0 0 1
v 1 0 1
v 1 1 1
v 0 1 1
vn 0 0 1
f 4 3 2 1
f 5//1 6//1 7//1 8//1
f -8 -7 -3 -4
f 2/1/1 3/2/1 7/3/1 6/4/1
f 3 4 8 \
  7
f 4 1 5 8
)";

double volume_of(const core::Result<MeshFile>& mesh) {
  EXPECT_TRUE(mesh.ok()) << mesh.error().message;
  if (!mesh.ok()) return 0;
  const auto m = mesh_mass_properties(mesh->vertices, mesh->indices, 1);
  EXPECT_TRUE(m.ok()) << m.error().message;
  return m.ok() ? m->volume : 0;
}
std::string message_of(std::string_view bytes, MeshFormat format, const MeshFileOptions& options = {}) {
  const auto mesh = parse_mesh(bytes, format, options, "file");
  return mesh.ok() ? std::string("ok") : mesh.error().message;
}

std::string stl_text(const Triangles& t) {
  std::string out = "solid test\n";
  char line[128];
  for (std::size_t i = 0; i < t.indices.size(); i += 3) {
    out += "facet normal 0 0 0\n outer loop\n";
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3f p = t.positions[t.indices[i + k]];
      std::snprintf(line, sizeof line, "  vertex %.9g %.9g %.9g\n", double(p.x), double(p.y), double(p.z));
      out += line;
    }
    out += " endloop\nendfacet\n";
  }
  return out + "endsolid test\n";
}
std::string stl_binary(const Triangles& t, const char* title) {
  std::string out(84, ' ');
  std::memcpy(out.data(), title, std::strlen(title));
  const std::uint32_t count = std::uint32_t(t.indices.size() / 3);
  std::memcpy(out.data() + 80, &count, 4);
  for (std::size_t i = 0; i < t.indices.size(); i += 3) {
    out.append(12, '\0');
    for (std::size_t k = 0; k < 3; ++k) out.append(reinterpret_cast<const char*>(&t.positions[t.indices[i + k]]), 12);
    out.append(2, '\0');
  }
  return out;
}

// A cube as glTF: twelve triangles of unsigned short indices, the buffer inside the JSON or as the second chunk.
std::string gltf_buffer() {
  const Triangles cube = make_box_mesh({0.5f, 0.5f, 0.5f});
  std::string bytes(reinterpret_cast<const char*>(cube.positions.data()), 12 * cube.positions.size());
  for (const std::uint32_t i : cube.indices) {
    const std::uint16_t index = std::uint16_t(i);
    bytes.append(reinterpret_cast<const char*>(&index), 2);
  }
  return bytes;
}
std::string base64(const std::string& bytes) {
  const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k) word = word << 8 | (i + k < bytes.size() ? std::uint8_t(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) out += i + k > bytes.size() ? '=' : digits[word >> (18 - 6 * k) & 63];
  }
  return out;
}
std::string gltf_json(const std::string& uri, const char* nodes, const char* accessor = R"("count": 36)") {
  const std::string buffer = uri.empty() ? R"({"byteLength": 168})" : R"({"byteLength": 168, "uri": ")" + uri + R"("})";
  return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": )" + std::string(nodes) +
         R"(, "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}], "buffers": [)" + buffer +
         R"(], "bufferViews": [{"buffer": 0, "byteLength": 96}, {"buffer": 0, "byteOffset": 96, "byteLength": 72}],
  "accessors": [{"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3"},
                {"bufferView": 1, "componentType": 5123, "type": "SCALAR", )" +
         accessor + "}]}";
}
std::string data_uri() { return "data:application/octet-stream;base64," + base64(gltf_buffer()); }
std::string glb() {
  std::string json = gltf_json("", R"([{"mesh": 0}])");
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const std::string bin = gltf_buffer();
  std::string out = "glTF";
  const auto word = [&out](std::size_t value) {
    const std::uint32_t bits = std::uint32_t(value);
    out.append(reinterpret_cast<const char*>(&bits), 4);
  };
  word(2), word(12 + 8 + json.size() + 8 + bin.size());
  word(json.size()), word(0x4E4F534A);
  out += json;
  word(bin.size()), word(0x004E4942);
  return out + bin;
}

TEST(MeshFileTest, ObjWithQuadsRelativeIndicesAndContinuedLines) {
  EXPECT_DOUBLE_EQ(volume_of(parse_mesh(cube_obj, MeshFormat::obj)), 1);
  EXPECT_DOUBLE_EQ(volume_of(parse_mesh(cube_obj, MeshFormat::obj, {.unit = 0.1})), 1e-3);
  std::string windows;
  for (const char* c = cube_obj; *c; ++c) windows += *c == '\n' ? std::string("\r\n") : std::string(1, *c);
  EXPECT_DOUBLE_EQ(volume_of(parse_mesh(windows, MeshFormat::obj)), 1);
}

TEST(MeshFileTest, ConcavePolygonsAreCutByEars) {
  // An L of area 3 in the plane: every triangle turns the same way.
  const auto mesh =
      parse_mesh("v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nf 4 5 6 1 2 3\n", MeshFormat::obj);
  ASSERT_TRUE(mesh.ok()) << mesh.error().message;
  ASSERT_EQ(mesh->indices.size(), 12u);
  double area = 0;
  for (std::size_t i = 0; i < 12; i += 3) {
    const Vec3d a = mesh->vertices[mesh->indices[i]];
    const double part = cross(mesh->vertices[mesh->indices[i + 1]] - a, mesh->vertices[mesh->indices[i + 2]] - a).z / 2;
    EXPECT_GT(part, 0);
    area += part;
  }
  EXPECT_DOUBLE_EQ(area, 3);
}

TEST(MeshFileTest, ObjErrorsNameTheLine) {
  EXPECT_NE(message_of("v 0 0 0\nv 1 zero 0\n", MeshFormat::obj).find("file: line 2: coordinate 2"), std::string::npos);
  EXPECT_NE(message_of("v 0 0\n", MeshFormat::obj).find("coordinate 3 of the vertex is missing"), std::string::npos);
  EXPECT_NE(message_of("v 0 0 nan\n", MeshFormat::obj).find("expected a number"), std::string::npos);
  EXPECT_NE(message_of("v 0 0 1e999\n", MeshFormat::obj).find("expected a number"), std::string::npos);
  EXPECT_NE(message_of("v 0 0 0\nf 1 1 2\n", MeshFormat::obj).find("vertex 2 of 1"), std::string::npos);
  EXPECT_NE(message_of("v 0 0 0\nf 1 1 -2\n", MeshFormat::obj).find("vertex -2 of 1"), std::string::npos);
  EXPECT_NE(message_of("v 0 0 0\nf 1 1 0\n", MeshFormat::obj).find("vertex 0 of 1"), std::string::npos);
  EXPECT_NE(message_of("v 0 0 0\nf 1 1 99999999999999999999\n", MeshFormat::obj).find("line 2"), std::string::npos);
  EXPECT_NE(message_of("v 0 0 0\nf 1 1\n", MeshFormat::obj).find("2 corners"), std::string::npos);
  EXPECT_NE(message_of("v 0 0 0\nf 1 x 1\n", MeshFormat::obj).find("'x'"), std::string::npos);
  EXPECT_NE(message_of("", MeshFormat::obj).find("no face"), std::string::npos);
  EXPECT_NE(message_of(cube_obj, MeshFormat::obj, {.max_triangles = 5}).find("more than 5"), std::string::npos);
  EXPECT_NE(message_of(cube_obj, MeshFormat::obj, {.max_bytes = 5}).find("at most 5"), std::string::npos);
  EXPECT_NE(message_of(cube_obj, MeshFormat::obj, {.unit = -1}).find("unit"), std::string::npos);
}

TEST(MeshFileTest, StlTextAndBinaryGiveTheSameSolid) {
  const Triangles torus = make_torus_mesh(2, 0.5f, 24, 12);
  const double text = volume_of(parse_mesh(stl_text(torus), MeshFormat::stl));
  EXPECT_GT(text, 8);
  // Nine digits in the text are the float of the binary file to half a unit of the tenth.
  EXPECT_NEAR(volume_of(parse_mesh(stl_binary(torus, "binary"), MeshFormat::stl)), text, 1e-7);
  EXPECT_NEAR(volume_of(parse_mesh(stl_binary(torus, "solid but binary"), MeshFormat::stl)), text, 1e-7);
}

TEST(MeshFileTest, StlErrors) {
  const Triangles box = make_box_mesh({1, 1, 1});
  const std::string text = stl_text(box), binary = stl_binary(box, "x");
  EXPECT_NE(message_of(text.substr(0, text.size() / 2), MeshFormat::stl).find("line"), std::string::npos);
  EXPECT_NE(message_of(binary.substr(0, 300), MeshFormat::stl).find("announces 12 facets"), std::string::npos);
  EXPECT_NE(message_of(binary.substr(0, 50), MeshFormat::stl).find("50 bytes"), std::string::npos);
  EXPECT_NE(message_of("solid a\nendsolid a\n", MeshFormat::stl).find("no facet"), std::string::npos);
  EXPECT_NE(message_of("solid a\nvertex 0 0 0\n", MeshFormat::stl).find("line 2"), std::string::npos);
  EXPECT_NE(message_of("solid a\nfacet\nvertex 0 0 a\n", MeshFormat::stl).find("coordinate 3"), std::string::npos);
  EXPECT_NE(message_of("solid a\nfacet\nendfacet\n", MeshFormat::stl).find("0 corners"), std::string::npos);
  std::string nan = binary;
  std::memset(nan.data() + 96, 0xFF, 4);
  EXPECT_NE(message_of(nan, MeshFormat::stl).find("corner 1 of facet 1"), std::string::npos);
}

TEST(MeshFileTest, FormatsAreDetected) {
  EXPECT_EQ(detect_mesh_format("a/b.OBJ", ""), MeshFormat::obj);
  EXPECT_EQ(detect_mesh_format("x.y.stl", ""), MeshFormat::stl);
  EXPECT_EQ(detect_mesh_format("x", "glTF...."), MeshFormat::glb);
  EXPECT_EQ(detect_mesh_format("x", " \n{"), MeshFormat::gltf);
  EXPECT_EQ(detect_mesh_format("x", cube_obj), MeshFormat::obj);
  EXPECT_EQ(detect_mesh_format("x", "PNG"), MeshFormat::unknown);
  EXPECT_NE(message_of("PNG", MeshFormat::unknown).find("not recognised"), std::string::npos);
}

TEST(MeshFileTest, FilesAreReadAndNamedInErrors) {
  const std::string path = ::testing::TempDir() + "carom_mesh_file_test.obj";
  std::FILE* file = std::fopen(path.c_str(), "wb");
  ASSERT_TRUE(file);
  std::fputs(cube_obj, file);
  std::fclose(file);
  EXPECT_DOUBLE_EQ(volume_of(read_mesh_file(path)), 1);
  std::remove(path.c_str());
  EXPECT_EQ(read_mesh_file(path).error().message, path + ": cannot be opened");
  EXPECT_FALSE(read_mesh_file(::testing::TempDir()).ok());
}

bool reads_gltf() { return message_of("{}", MeshFormat::gltf).find("this build") == std::string::npos; }

TEST(MeshFileTest, GltfWithDataUriAndGlb) {
  if (!reads_gltf()) GTEST_SKIP() << "built without tinygltf";
  EXPECT_DOUBLE_EQ(volume_of(parse_mesh(gltf_json(data_uri(), R"([{"mesh": 0}])"), MeshFormat::gltf)), 1);
  EXPECT_DOUBLE_EQ(volume_of(parse_mesh(glb(), MeshFormat::glb)), 1);
}

TEST(MeshFileTest, GltfNodesArePlacedAndMirroredNodesStaySolid) {
  if (!reads_gltf()) GTEST_SKIP() << "built without tinygltf";
  const auto mesh =
      parse_mesh(gltf_json(data_uri(), R"([{"scale": [2, 3, -4], "translation": [10, 0, 0], "mesh": 0, "children": [1]},
                                {"translation": [5, 0, 0], "rotation": [0, 0, 0.7071067811865476, 0.7071067811865476], "mesh": 0}])"),
                 MeshFormat::gltf);
  EXPECT_DOUBLE_EQ(volume_of(mesh), 48);
  ASSERT_TRUE(mesh.ok());
  EXPECT_EQ(mesh->parts, 2);
  const auto m = mesh_mass_properties(mesh->vertices, mesh->indices, 1);
  EXPECT_NEAR(m->properties.center.x, 15, 1e-12);  // half at 10, half at 10 + 2·5
}

TEST(MeshFileTest, GltfErrors) {
  if (!reads_gltf()) GTEST_SKIP() << "built without tinygltf";
  const auto with = [](const char* nodes, const char* accessor) {
    return message_of(gltf_json(data_uri(), nodes, accessor), MeshFormat::gltf);
  };
  EXPECT_NE(with(R"([{"mesh": 0}])", R"("count": 37)").find("outside its buffer view"), std::string::npos);
  EXPECT_NE(with(R"([{"mesh": 0}])", R"("count": 36, "byteOffset": 2)").find("outside"), std::string::npos);
  EXPECT_NE(with(R"([{"mesh": 0}])", R"("count": 4000000000)").find("outside"), std::string::npos);
  EXPECT_NE(with(R"([{"mesh": 7}])", R"("count": 36)").find("mesh 7 of 1"), std::string::npos);
  EXPECT_NE(with(R"([{"mesh": 0, "children": [0]}])", R"("count": 36)").find("reached twice"), std::string::npos);
  EXPECT_NE(with(R"([{"mesh": 0, "children": [3]}])", R"("count": 36)").find("node 3 of 1"), std::string::npos);
  EXPECT_NE(message_of(gltf_json("../secret.bin", R"([{"mesh": 0}])"), MeshFormat::gltf).find("not a valid"),
            std::string::npos);
  EXPECT_NE(message_of(gltf_json("/etc/passwd", R"([{"mesh": 0}])"), MeshFormat::gltf).find("not a valid"),
            std::string::npos);
  EXPECT_NE(message_of("{\"a\":" + std::string(100000, '['), MeshFormat::gltf).find("nested"), std::string::npos);
  EXPECT_NE(message_of("{ \"a\": 1 }", MeshFormat::gltf).find("not a valid"), std::string::npos);
  const std::string whole = glb();
  for (std::size_t n = 0; n < whole.size(); n += 7)
    EXPECT_NE(message_of(whole.substr(0, n), MeshFormat::glb), "ok") << n;
}

TEST(MeshFileTest, GltfBuffersLieBesideTheFile) {
  if (!reads_gltf()) GTEST_SKIP() << "built without tinygltf";
  const std::string folder = ::testing::TempDir();
  const auto write = [](const std::string& path, const std::string& bytes) {
    std::FILE* file = std::fopen(path.c_str(), "wb");
    ASSERT_TRUE(file);
    std::fwrite(bytes.data(), 1, bytes.size(), file);
    std::fclose(file);
  };
  write(folder + "/carom_test_buffer.bin", gltf_buffer());
  write(folder + "/carom_test.gltf", gltf_json("carom_test_buffer.bin", R"([{"mesh": 0}])"));
  EXPECT_DOUBLE_EQ(volume_of(read_mesh_file(folder + "/carom_test.gltf")), 1);
  write(folder + "/carom_test.gltf", gltf_json("../carom_test_buffer.bin", R"([{"mesh": 0}])"));
  EXPECT_FALSE(read_mesh_file(folder + "/carom_test.gltf").ok());
  write(folder + "/carom_test.gltf", gltf_json(folder + "/carom_test_buffer.bin", R"([{"mesh": 0}])"));
  EXPECT_FALSE(read_mesh_file(folder + "/carom_test.gltf").ok());
  std::remove((folder + "/carom_test.gltf").c_str());
  std::remove((folder + "/carom_test_buffer.bin").c_str());
}

}  // namespace
}  // namespace carom::geometry::mesh_file_test
