// Where pictures of a run go: numbered PNG files, one GIF, or one MP4 through ffmpeg.
#pragma once

#include <memory>
#include <string>

#include "apps/command/canvas.h"

namespace carom::command {

class Movie {
 public:
  virtual ~Movie() = default;
  /// The next picture: a Cairo image of 32-bit pixels in the movie's size.
  virtual core::Status add(cairo_surface_t* picture) = 0;
  /// Makes the file whole and gives it its name. Without this nothing is left of a movie.
  virtual core::Status finish() = 0;
};

/// By the ending of `path`: .gif, .mp4, or else a folder for PNG files. `rate`: pictures a second.
core::Result<std::unique_ptr<Movie>> make_movie(const std::string& path, int width, int height, double rate);

}  // namespace carom::command
