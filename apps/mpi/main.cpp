// carom-mpi: one shard of a sweep for every process of an MPI job.
//   mpirun -n 8 carom-mpi chain --vary ratio=1:1000:400 --out /shared/chain
// The arguments are those of `carom sweep`, without --shard. The folder must be one that all machines see. A job that
// was killed goes on where it was when it is started again with as many processes; whoever ends last writes the table.
#include <mpi.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

extern char** environ;  // NOLINT(readability-redundant-declaration): POSIX leaves it to programs

namespace {

/// The program `carom`: CAROM names it, or it lies beside this one or in the folder beside (a build), or on the path.
std::string program() {
  if (const char* named = std::getenv("CAROM")) return named;
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path here = fs::read_symlink("/proc/self/exe", error).parent_path();
  for (const fs::path& path : {here / "carom", here.parent_path() / "command" / "carom"})
    if (fs::is_regular_file(path, error)) return path.string();
  return "carom";
}

int run(const std::vector<std::string>& arguments) {
  std::vector<char*> pointers;
  for (const std::string& a : arguments) pointers.push_back(const_cast<char*>(a.c_str()));
  pointers.push_back(nullptr);
  pid_t child = 0;
  if (const int error = posix_spawnp(&child, pointers[0], nullptr, nullptr, pointers.data(), environ); error != 0) {
    std::fprintf(stderr, "carom-mpi: cannot start %s: %s; CAROM names the program\n", pointers[0],
                 std::strerror(error));
    return 127;
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

int main(int count, char** arguments) {
  MPI_Init(&count, &arguments);
  int rank = 0, size = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  std::vector<std::string> command = {program(), "sweep"};
  bool usable = count > 1;
  for (int i = 1; i < count; ++i) {
    usable = usable && std::strncmp(arguments[i], "--shard", 7) != 0;
    command.emplace_back(arguments[i]);
  }
  int result = 2;
  if (usable) {
    command.emplace_back("--shard");
    command.push_back(std::to_string(rank) + "/" + std::to_string(size));
    if (rank != 0) command.emplace_back("--quiet");
    result = run(command);
  } else if (rank == 0) {
    std::fputs("carom-mpi: expected the arguments of `carom sweep`, without --shard\n", stderr);
  }
  // The job's exit status is the worst of its shards'.
  int worst = 0;
  MPI_Allreduce(&result, &worst, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
  MPI_Finalize();
  return worst;
}
