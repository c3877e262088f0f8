#include "apps/command/movie.h"

#include <fcntl.h>
#include <gif_lib.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <vector>

extern char** environ;  // NOLINT(readability-redundant-declaration): POSIX leaves it to programs

namespace carom::command {

namespace fs = std::filesystem;

namespace {

class Folder final : public Movie {
 public:
  explicit Folder(std::string path) : path_(std::move(path)) {}
  core::Status add(cairo_surface_t* picture) override {
    char name[32];
    std::snprintf(name, sizeof name, "frame-%06d.png", count_++);
    return write_png(picture, (fs::path(path_) / name).string());
  }
  core::Status finish() override { return {}; }

 private:
  std::string path_;
  int count_ = 0;
};

/// Every picture has a palette of its own. Delays are whole hundredths of a second: they alternate so that the movie
/// keeps time.
class Gif final : public Movie {
 public:
  static core::Result<std::unique_ptr<Movie>> open(const std::string& path, int width, int height, double rate) {
    auto gif = std::make_unique<Gif>();
    int error = 0;
    gif->path_ = path;
    gif->rate_ = rate;
    gif->width_ = width;
    gif->height_ = height;
    const int file = ::open(temporary_name(path).c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (file < 0) return core::Error{path + ": cannot write: " + std::strerror(errno)};
    gif->file_ = EGifOpenFileHandle(file, &error);
    if (!gif->file_) return core::Error{path + ": cannot write: " + GifErrorString(error)};
    EGifSetGifVersion(gif->file_, true);
    // The extension that makes browsers repeat a movie for ever.
    const unsigned char forever[] = {1, 0, 0};
    if (EGifPutScreenDesc(gif->file_, width, height, 8, 0, nullptr) == GIF_ERROR ||
        EGifPutExtensionLeader(gif->file_, APPLICATION_EXT_FUNC_CODE) == GIF_ERROR ||
        EGifPutExtensionBlock(gif->file_, 11, "NETSCAPE2.0") == GIF_ERROR ||
        EGifPutExtensionBlock(gif->file_, 3, forever) == GIF_ERROR || EGifPutExtensionTrailer(gif->file_) == GIF_ERROR)
      return gif->broken();
    return std::unique_ptr<Movie>(std::move(gif));
  }
  ~Gif() override {
    int error = 0;
    if (file_) EGifCloseFile(file_, &error);
  }

  core::Status add(cairo_surface_t* picture) override {
    cairo_surface_flush(picture);
    const unsigned char* data = cairo_image_surface_get_data(picture);
    const int stride = cairo_image_surface_get_stride(picture);
    const std::size_t pixels = std::size_t(width_) * std::size_t(height_);
    red_.resize(pixels), green_.resize(pixels), blue_.resize(pixels), index_.resize(pixels);
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) {
        std::uint32_t rgb;
        std::memcpy(&rgb, data + std::ptrdiff_t(y) * stride + 4 * x, 4);
        const std::size_t i = std::size_t(y) * std::size_t(width_) + std::size_t(x);
        red_[i] = GifByteType(rgb >> 16), green_[i] = GifByteType(rgb >> 8), blue_[i] = GifByteType(rgb);
      }
    }
    int colors = 256;
    GifColorType palette[256] = {};
    if (GifQuantizeBuffer(unsigned(width_), unsigned(height_), &colors, red_.data(), green_.data(), blue_.data(),
                          index_.data(), palette) == GIF_ERROR)
      return core::Error{path_ + ": no memory for the colours of a picture"};
    const long long due = std::llround(100 * double(++count_) / rate_);
    GraphicsControlBlock control{};
    control.DelayTime = int(due - shown_);
    control.TransparentColor = NO_TRANSPARENT_COLOR;
    shown_ = due;
    GifByteType extension[4];
    EGifGCBToExtension(&control, extension);
    ColorMapObject* map = GifMakeMapObject(256, palette);
    const bool ok = map && EGifPutExtension(file_, GRAPHICS_EXT_FUNC_CODE, 4, extension) != GIF_ERROR &&
                    EGifPutImageDesc(file_, 0, 0, width_, height_, false, map) != GIF_ERROR;
    GifFreeMapObject(map);
    if (!ok) return broken();
    for (int y = 0; y < height_; ++y)
      if (EGifPutLine(file_, index_.data() + std::size_t(y) * std::size_t(width_), width_) == GIF_ERROR)
        return broken();
    return {};
  }

  core::Status finish() override {
    int error = 0;
    const bool ok = EGifCloseFile(std::exchange(file_, nullptr), &error) != GIF_ERROR;
    if (!ok) return core::Error{path_ + ": cannot write: " + GifErrorString(error)};
    return put_in_place(temporary_name(path_), path_);
  }

 private:
  core::Error broken() const { return core::Error{path_ + ": cannot write: " + GifErrorString(file_->Error)}; }

  std::string path_;
  GifFileType* file_ = nullptr;
  int width_ = 0, height_ = 0;
  double rate_ = 30;
  long long shown_ = 0, count_ = 0;
  std::vector<GifByteType> red_, green_, blue_, index_;
};

/// Raw pixels into ffmpeg, a program of its own.
class Mp4 final : public Movie {
 public:
  static core::Result<std::unique_ptr<Movie>> open(const std::string& path, int width, int height, double rate) {
    auto movie = std::make_unique<Mp4>();
    movie->path_ = path;
    movie->width_ = width;
    movie->height_ = height;
    int ends[2];
    if (pipe(ends) != 0) return core::Error{path + ": no pipe to ffmpeg: " + std::strerror(errno)};
    std::signal(SIGPIPE, SIG_IGN);  // where ffmpeg ends early, a write says so
    const std::string size = std::to_string(width) + "x" + std::to_string(height), part = temporary_name(path);
    const std::string speed = std::to_string(rate);
    const char* arguments[] = {"ffmpeg",    "-y",         "-loglevel",  "error", "-f",          "rawvideo", "-pix_fmt",
                               "bgr0",      "-s",         size.c_str(), "-r",    speed.c_str(), "-i",       "-",
                               "-an",       "-c:v",       "libx264",    "-crf",  "20",          "-pix_fmt", "yuv420p",
                               "-movflags", "+faststart", "-f",         "mp4",   part.c_str(),  nullptr};
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[0], 0);
    posix_spawn_file_actions_addclose(&actions, ends[1]);
    const int error = posix_spawnp(&movie->child_, "ffmpeg", &actions, nullptr, const_cast<char**>(arguments), environ);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[0]);
    movie->input_ = ends[1];
    if (error != 0) {
      movie->child_ = 0;
      return core::Error{path + ": MP4 needs the program ffmpeg (Debian: apt-get install ffmpeg): " +
                         std::strerror(error) + "; .gif and folders of PNG do without"};
    }
    return std::unique_ptr<Movie>(std::move(movie));
  }
  ~Mp4() override { (void)end(); }

  core::Status add(cairo_surface_t* picture) override {
    cairo_surface_flush(picture);
    const unsigned char* data = cairo_image_surface_get_data(picture);
    const int stride = cairo_image_surface_get_stride(picture);
    for (int y = 0; y < height_; ++y) {
      const unsigned char* row = data + std::ptrdiff_t(y) * stride;
      for (std::size_t at = 0, size = 4 * std::size_t(width_); at < size;) {
        const ssize_t n = write(input_, row + at, size - at);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) return core::Error{path_ + ": ffmpeg takes no more pictures: " + std::strerror(errno)};
        at += std::size_t(n);
      }
    }
    return {};
  }

  core::Status finish() override {
    if (const int status = end(); status != 0)
      return core::Error{path_ + ": ffmpeg ended with status " + std::to_string(status)};
    return put_in_place(temporary_name(path_), path_);
  }

 private:
  int end() {
    if (input_ >= 0) close(std::exchange(input_, -1));
    if (child_ == 0) return 0;
    int status = 0;
    while (waitpid(child_, &status, 0) < 0 && errno == EINTR) {
    }
    child_ = 0;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  std::string path_;
  int width_ = 0, height_ = 0, input_ = -1;
  pid_t child_ = 0;
};

}  // namespace

core::Result<std::unique_ptr<Movie>> make_movie(const std::string& path, int width, int height, double rate) {
  const std::string ending = fs::path(path).extension().string();
  const bool file = ending == ".gif" || ending == ".mp4";
  std::error_code error;
  const fs::path folder = file ? fs::path(path).parent_path() : fs::path(path);
  if (!folder.empty()) fs::create_directories(folder, error);
  if (error) return core::Error{folder.string() + ": cannot make the folder: " + error.message()};
  if (ending == ".gif") return Gif::open(path, width, height, rate);
  if (ending == ".mp4") return Mp4::open(path, width, height, rate);
  return std::unique_ptr<Movie>(std::make_unique<Folder>(path));
}

}  // namespace carom::command
