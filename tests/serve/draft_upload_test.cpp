// Uploads that are refused, break off, are too large, damaged or malicious: nothing remains and nothing else is opened.
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "serve/draft_fixture.hpp"
#include "support/witness.hpp"

namespace talus::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

TEST_F(NewScenePage, nothing_remains_of_what_is_refused) {
    const std::string text =
        "<VRTDataset rasterXSize=\"2\" rasterYSize=\"2\"><VRTRasterBand dataType=\"Byte\" band=\"1\">"
        "<SimpleSource><SourceFilename>/etc/passwd</SourceFilename></SimpleSource></VRTRasterBand>"
        "</VRTDataset>";
    EXPECT_EQ(put("terrain", "dem.tif", "no raster at all").status, 400);
    EXPECT_EQ(put("terrain", "dem.tif", "").status, 400);
    EXPECT_THAT(put("terrain", "dem.tif", text).body, HasSubstr("may name other files"));
    EXPECT_EQ(put("release", "scar.geojson", "{}").status, 400);
    EXPECT_EQ(put("buildings", "houses.tif", read_text(scene_.input("terrain.tif"))).status, 400);
    EXPECT_THAT(put("release", "scar.shp", "x").body, HasSubstr("ZIP"));
    EXPECT_EQ(put("bundle", "scene.zip", zip({{"readme.txt", {}, "x"}})).status, 400);
    EXPECT_EQ(put("terrain", "dem.zip", zip({{"a.txt", {}, "x"}})).status, 400);
    EXPECT_THAT(put("terrain", "dem.zip", "PK").body, HasSubstr("dem.zip: is not a ZIP archive"));
    // Nor what gzip packed.
    EXPECT_THAT(put("terrain", "dem.tif.gz", "no gzip").body, HasSubstr("dem.tif.gz: is not a gzip file"));
    EXPECT_EQ(put("terrain", "dem.tif.gz", gzip("no raster at all")).status, 400);
    EXPECT_THAT(put("terrain", "dem.tar.gz", gzip("x")).body, HasSubstr("in a ZIP archive"));
    EXPECT_THAT(put("terrain", "dem.tgz", gzip("x")).body, HasSubstr("in a ZIP archive"));
    EXPECT_THAT(put("terrain", "dem.zip.gz", gzip("x")).body, HasSubstr("in a ZIP archive"));
    EXPECT_THAT(put("release", "scar.shp.gz", gzip("x")).body, HasSubstr("pack all of them in one ZIP"));
    EXPECT_EQ(put("nothing", "dem.tif", "x").status, 404);
    EXPECT_EQ(client_->ask("PUT", draft_ + "/files/terrain", "x").status, 400);
    EXPECT_EQ(kept(), std::vector<std::string>());
    // A refused file leaves the one before it.
    put_file("terrain", scene_.input("terrain.tif"));
    EXPECT_EQ(put("terrain", "dem.tif", "no raster at all").status, 400);
    EXPECT_EQ(kept(), std::vector<std::string>{"terrain.tif"});
    EXPECT_EQ(client_->get(draft_).json()["files"]["terrain"]["name"], "terrain.tif");
    EXPECT_EQ(client_->ask("DELETE", draft_).status, 200);
    EXPECT_EQ(kept(), std::vector<std::string>());
}

TEST_F(NewScenePage, names_lead_nowhere) {
    const std::string terrain = read_text(scene_.input("terrain.tif"));
    ASSERT_EQ(put("terrain", "..%2F..%2F..%2Fevil%20%3Bname.TIF", terrain).status, 200);
    EXPECT_EQ(kept(), std::vector<std::string>{"evil-name.tif"});
    EXPECT_EQ(put("..%2Fterrain", "dem.tif", terrain).status, 409) << "no route of a page without a session";
    const std::string packed = zip({{"inner/dem.tif", scene_.input("terrain.tif")}, {"inner/other.vrt", {}, "<VRT"}});
    ASSERT_EQ(put("terrain", "dem.zip", packed).status, 200);
    EXPECT_EQ(kept(), std::vector<std::string>{"dem.tif"}) << "a virtual raster beside it does not stay";
    std::string evil = packed;  // the same length, in the local header and in the directory
    for (std::size_t at = 0; (at = evil.find("inner/dem.tif", at)) != std::string::npos;)
        evil.replace(at, 13, "../../dem.tif");
    const Answer out = put("terrain", "dem.zip", evil);
    EXPECT_EQ(out.status, 400);
    EXPECT_EQ(kept(), std::vector<std::string>{"dem.tif"});
}

TEST_F(NewScenePage, what_is_too_large_is_refused) {
    limits_ = {200000, 5, 3000};
    start();
    SetUp();
    // By its header, before anything is read, and while it comes.
    EXPECT_EQ(put("terrain", "dem.tif", std::string(200001, 'x')).status, 413);
    client_ = std::make_unique<HttpClient>(server_->port(), controller);
    ASSERT_EQ(put("release", "a.geojson", read_text(scene_.input("release.geojson")) + std::string(120000, ' ')).status,
              200);
    EXPECT_EQ(put("terrain", "dem.tif", std::string(150000, 'x')).status, 413);
    client_ = std::make_unique<HttpClient>(server_->port(), controller);
    Socket chunks(server_->port());
    std::string buffer;
    chunks.send(
        fmt::format("PUT {}/files/terrain?name=a.tif HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nAuthorization: Bearer {}\r\n"
                    "Transfer-Encoding: chunked\r\n\r\n",
                    draft_, server_->port(), controller));
    for (int i = 0; i < 30; ++i) chunks.send("4000\r\n" + std::string(0x4000, 'x') + "\r\n");
    EXPECT_EQ(read_answer(chunks, buffer).status, 413);
    // An archive of a megabyte of zeros has a thousand bytes.
    const Answer bomb = put("terrain", "dem.zip", zip({{"dem.tif", {}, std::string(1000000, '\0')}}));
    EXPECT_EQ(bomb.status, 400);
    EXPECT_THAT(bomb.body, HasSubstr("unpacked"));
    const Answer packed = put("terrain", "dem.tif.gz", gzip(std::string(1000000, '\0')));
    EXPECT_EQ(packed.status, 400);
    EXPECT_THAT(packed.body, HasSubstr("unpacked"));
    std::vector<geo::ZipEntry> many;
    for (int i = 0; i < 6; ++i) many.push_back({fmt::format("{}.txt", i), {}, "x"});
    EXPECT_THAT(put("terrain", "dem.zip", zip(many)).body, HasSubstr("more than 5 files"));
    RasterOptions options = SmallScene::terrain();
    options.columns = 51;
    options.rows = 59;
    EXPECT_THAT(put_file("terrain", write_plane(scene_.input("large.tif"), options)).body, HasSubstr("51 x 59 cells"));
    options.epsg = 0;
    options.columns = 50;
    options.creation_options = {"COMPRESS=DEFLATE"};
    ASSERT_EQ(put_file("terrain", write_plane(scene_.input("large.tif"), options)).status, 200);
    EXPECT_EQ(kept(), (std::vector<std::string>{"a.gpkg", "large.tif"}));
}

TEST_F(NewScenePage, a_broken_upload_leaves_nothing_and_another_draft_takes_the_place) {
    const std::string head = fmt::format(
        "PUT {}/files/terrain?name=a.tif HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n"
        "Authorization: Bearer {}\r\nContent-Length: 1000000\r\n\r\n",
        draft_, server_->port(), controller);
    const auto wait_for = [&](std::size_t files) {
        for (int i = 0; i < 400 && kept().size() != files; ++i) std::this_thread::sleep_for(Milliseconds(25));
        return kept().size();
    };
    {
        Socket broken(server_->port());
        broken.send(head + std::string(600000, 'x'));
        EXPECT_EQ(wait_for(1), 1U) << "it comes piece by piece";
        broken.kill();
    }
    EXPECT_EQ(wait_for(0), 0U);
    Socket slow(server_->port());
    slow.send(head + std::string(600000, 'x'));
    EXPECT_EQ(wait_for(1), 1U);
    const std::string former = draft_;
    draft_ = "/api/draft/" + begin();
    EXPECT_EQ(wait_for(0), 0U);
    slow.send(std::string(400000, 'x'));
    std::string buffer;
    EXPECT_EQ(read_answer(slow, buffer).status, 404);
    EXPECT_EQ(client_->get(former).status, 404);
    put_file("terrain", scene_.input("terrain.tif"));
    server_.reset();
    EXPECT_EQ(kept(), std::vector<std::string>()) << "nothing remains when the program ends";
}

TEST_F(NewScenePage, viewers_upload_nothing_and_what_a_dead_program_left_is_removed) {
    HttpClient eye(server_->port(), viewer), nobody(server_->port());
    EXPECT_EQ(eye.ask("POST", "/api/draft", "{}").status, 403);
    EXPECT_EQ(eye.get(draft_).status, 403);
    EXPECT_EQ(eye.ask("PUT", draft_ + "/files/terrain?name=a.tif", "x").status, 403);
    EXPECT_EQ(nobody.ask("PUT", draft_ + "/files/terrain?name=a.tif", "x").status, 401);
    EXPECT_EQ(eye.post(draft_ + "/scene", json::object()).status, 403);
    EXPECT_EQ(eye.get("/api/scenes/sham_tseng/bundle").status, 403);
    EXPECT_EQ(eye.ask("DELETE", "/api/scenes/" + id()).status, 403);
    EXPECT_EQ(kept(), std::vector<std::string>());
    server_.reset();
    fs::create_directories(folder() / "drafts/999999999-x/data");  // no process has this number
    write_text((folder() / "drafts/999999999-x/data/a.tif").string(), "x");
    fs::create_directories(folder() / fmt::format("drafts/{}-x", getpid()));
    start();
    client_ = std::make_unique<HttpClient>(server_->port(), controller);
    begin();
    EXPECT_FALSE(fs::exists(folder() / "drafts/999999999-x"));
    EXPECT_TRUE(fs::exists(folder() / fmt::format("drafts/{}-x", getpid())));
}

/// A GeoPackage whose second layer never ends.
std::string endless_geopackage(const std::string& file) {
    VectorOptions options;
    options.driver = "GPKG";
    options.layer = "scar";
    write_vector(file, options, {{rectangle_wkt(824200, 825090, 824220, 825110), {}}});
    const GDALDatasetUniquePtr data(GDALDataset::Open(file.c_str(), GDAL_OF_VECTOR | GDAL_OF_UPDATE));
    for (const char* command :
         {"CREATE VIEW endless AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) SELECT n.i AS fid, "
          "scar.geom AS geom FROM n, scar WHERE n.i < 0",
          "INSERT INTO gpkg_contents (table_name, identifier, data_type, srs_id) SELECT 'endless', 'endless', "
          "'features', srs_id FROM gpkg_contents WHERE table_name = 'scar'",
          "INSERT INTO gpkg_geometry_columns SELECT 'endless', column_name, geometry_type_name, srs_id, z, m FROM "
          "gpkg_geometry_columns WHERE table_name = 'scar'"}) {
        data->ReleaseResultSet(data->ExecuteSQL(command, nullptr, nullptr));
    }
    return file;
}

TEST_F(NewScenePage, a_file_that_is_read_without_end_blocks_neither_a_new_scene_nor_the_end_of_the_program) {
    const std::string endless = read_text(endless_geopackage(scene_.input("endless.gpkg")));
    const auto reading = [&] {  // until its child is at work
        for (int i = 0; i < 400; ++i) {
            for (const std::string& name : kept()) {
                if (name.ends_with(".numbers")) return true;
            }
            std::this_thread::sleep_for(Milliseconds(25));
        }
        return false;
    };
    Answer refused;
    const auto upload = [&](const std::string& draft) {
        return std::thread([&, draft] {
            HttpClient other(server_->port(), controller);
            refused = other.ask("PUT", draft + "/files/release?name=endless.gpkg", endless);
        });
    };
    std::thread first = upload(draft_);
    ASSERT_TRUE(reading());
    const auto begun = std::chrono::steady_clock::now();
    draft_ = "/api/draft/" + begin();  // in its place
    first.join();
    EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::seconds(10));
    EXPECT_THAT(refused.body, HasSubstr("cancelled"));
    ASSERT_EQ(put_file("terrain", scene_.input("terrain.tif")).status, 200);
    // Another one, and the end.
    std::thread second = upload(draft_);
    ASSERT_TRUE(reading());
    const auto ending = std::chrono::steady_clock::now();
    server_.reset();
    EXPECT_LT(std::chrono::steady_clock::now() - ending, std::chrono::seconds(10));
    second.join();
    EXPECT_EQ(kept(), std::vector<std::string>());
}

TEST_F(NewScenePage, what_is_uploaded_in_any_role_opens_nothing_else) {
    write_plane(scene_.input("secret.tif"));
    fs::create_directories(folder() / "secret");
    fs::rename(scene_.input("secret.tif"), folder() / "secret/secret.tif");
    const std::string secret = (folder() / "secret/secret.tif").string();
    for (const std::string& place : {secret, std::string("/vsicurl/http://127.0.0.9:9/a.tif")}) {
        const std::string layer = "<OGRVRTDataSource><OGRVRTLayer name=\"a\"><SrcDataSource>" + place +
                                  "</SrcDataSource></OGRVRTLayer></OGRVRTDataSource>";
        const std::string text = "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 5\n" + layer + "\n1 2\n3 4\n";
        const std::string scene_text =
            "[terrain]\nfile = \"dem.asc\"\n[[release]]\nfile = \"dem.asc\"\nthickness_m = 1\n";
        const std::string bundle = zip({{"scene.toml", {}, scene_text}, {"dem.asc", {}, text}});
        const std::string variant = zip(
            {{"scene.toml", {}, scene_text + "[[variant]]\nname = \"a\"\nset = ['terrain.file=\"" + place + "\"']\n"},
             {"dem.asc", {}, text}});
        const Witness witness(scene_.input("log"));
        for (const char* role : {"terrain", "release", "buildings", "orthophoto"}) {
            // A raster of which some numbers are none; no layer.
            EXPECT_EQ(put(role, "dem.asc", text).status, role == std::string("buildings") ? 400 : 200) << role;
            EXPECT_EQ(put(role, "dem.vrt", layer).status, 400) << role;
            EXPECT_EQ(put(role, "dem.json", layer).status, 400) << role;
        }
        EXPECT_EQ(put("bundle", "a.zip", bundle).status, 400);
        EXPECT_THAT(put("bundle", "a.zip", variant).body, HasSubstr("variant"));
        EXPECT_THAT(witness.elsewhere({(folder() / "drafts").string(), scene_.input("exports")}),
                    testing::Each(testing::AnyOf(testing::StartsWith("connect 127.0.0.1"),
                                                 testing::StartsWith("socket"), HasSubstr("packed.zip"))))
            << "the test's own client connects to the server";
    }
}

TEST(Draft, names_of_uploads_are_plain) {
    EXPECT_EQ(serve::upload_name_of("../../etc/pass wd.TIF"), "pass-wd.tif");
    EXPECT_EQ(serve::upload_name_of("Häuser.city.json"), "h-user.city.json");
    EXPECT_EQ(serve::upload_name_of(".tif"), "tif");
    EXPECT_EQ(serve::upload_name_of("..."), "file");
    EXPECT_EQ(serve::upload_name_of("a.b/c.tif\n"), "c.tif");
    EXPECT_EQ(serve::upload_name_of(""), "file");
}

/// What becomes of a file on its way from somebody who means harm: bytes replaced, cut off, repeated, or set to the
/// numbers at which sizes and offsets overflow. The same for the same seed.
std::string damaged(std::string bytes, std::uint64_t seed) {
    std::uint64_t state = seed * 0x9E3779B97F4A7C15U + 1;
    const auto below = [&](std::size_t most) {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        return static_cast<std::size_t>(state % std::max<std::size_t>(1, most));
    };
    constexpr std::uint32_t edges[] = {0, 1, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 0x7FFF, 0xFFFF, 0x40000000};
    for (std::size_t k = 0, count = 1 + below(8); k < count && bytes.size() > 8; ++k) {
        // Headers are where harm is done: every second change is among the first bytes.
        const std::size_t at = below(k % 2 == 0 ? std::min<std::size_t>(bytes.size(), 400) : bytes.size());
        switch (below(5)) {
            case 0:
                bytes[at] = static_cast<char>(below(256));
                break;
            case 1:
                std::memcpy(bytes.data() + std::min(at, bytes.size() - 4), &edges[below(std::size(edges))], 4);
                break;
            case 2:
                bytes.resize(std::max<std::size_t>(8, at));
                break;
            case 3:
                bytes.insert(at, bytes.substr(below(bytes.size()), below(64)));
                break;
            default:
                bytes.erase(at, below(32));
        }
    }
    return bytes;
}

TEST_F(NewScenePage, damaged_files_are_refused_in_a_sentence_or_taken_and_harm_nothing) {
    limits_ = {2'000'000, 20, 100'000};
    start();
    SetUp();
    RasterOptions packed = SmallScene::terrain();
    packed.creation_options = {"COMPRESS=DEFLATE", "TILED=YES"};
    write_plane(scene_.input("tiled.tif"), packed);
    const std::string raster = read_text(scene_.input("terrain.tif")), tiled = read_text(scene_.input("tiled.tif"));
    const std::string layer = read_text(scene_.input("release.geojson"));
    std::vector<geo::ZipEntry> parts;
    VectorOptions shape;
    shape.driver = "ESRI Shapefile";
    shape.layer = "scar";
    write_vector(scene_.input("scar.shp"), shape, {{rectangle_wkt(824200, 825090, 824220, 825110), {}}});
    for (const char* ending : {".shp", ".shx", ".dbf", ".prj"}) {
        parts.push_back({std::string("scar") + ending, scene_.input(std::string("scar") + ending)});
    }
    const std::string shapes = zip(parts);
    struct Kind {
        const char *role, *name;
        const std::string* content;
    };
    const Kind kinds[] = {{"terrain", "dem.tif", &raster},         {"terrain", "dem.tif", &tiled},
                          {"release", "scar.geojson", &layer},     {"release", "scar.zip", &shapes},
                          {"buildings", "houses.geojson", &layer}, {"orthophoto", "photo.tif", &tiled}};
    int taken = 0, refused = 0;
    for (std::uint64_t seed = 0; seed < 12; ++seed) {  // a process for each
        for (const Kind& kind : kinds) {
            SCOPED_TRACE(fmt::format("{} {} seed {}", kind.role, kind.name, seed));
            const Answer answer = put(kind.role, kind.name, damaged(*kind.content, seed));
            ASSERT_TRUE(answer.status == 200 || answer.status == 400) << answer.status << " " << answer.body;
            (answer.status == 200 ? taken : refused) += 1;
            if (answer.status != 200) {
                const std::string sentence = answer.json()["error"];
                EXPECT_FALSE(sentence.empty());
                EXPECT_THAT(sentence, Not(HasSubstr("\n")));
                EXPECT_THAT(sentence, Not(HasSubstr(folder().string())));
            }
        }
        const Answer checked = check({{"scar", scar()}, {"thickness_m", 1}});
        ASSERT_TRUE(checked.status == 200 || checked.status == 400) << checked.status << " " << checked.body;
    }
    EXPECT_GT(taken, 1) << "some of the damage is where nobody looks";
    EXPECT_GT(refused, 30);
    std::uintmax_t bytes = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder() / "drafts")) {
        if (entry.is_regular_file()) bytes += entry.file_size();
    }
    EXPECT_LE(bytes, limits_.bytes);
    // The server has come through it: a good scene can still be made.
    EXPECT_EQ(client_->ask("DELETE", draft_).status, 200);
    draft_ = "/api/draft/" + begin();
    ASSERT_EQ(put_file("terrain", scene_.input("terrain.tif")).status, 200);
    EXPECT_EQ(check({{"scar", scar()}, {"thickness_m", 2}}).status, 200);
}

}  // namespace
}  // namespace talus::test
