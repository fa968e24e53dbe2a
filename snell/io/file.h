// Whole files in and out, with errors that say what to do.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace snell {

// The bytes of a regular file. Throws Error (with the file as place) if it is missing, a folder, a device or a pipe,
// unreadable, or larger than memory.
std::string read_file(const std::filesystem::path& file);

// A regular file, read from its beginning to its end. Throws Error as read_file() does.
class InputFile
{
  public:
    explicit InputFile(const std::filesystem::path& file);
    ~InputFile();
    InputFile(const InputFile&) = delete;
    InputFile& operator=(const InputFile&) = delete;

    // Fills up to `size` bytes and returns how many; fewer only at the end.
    std::size_t read(char* to, std::size_t size);

    // As the system reports it: 0 where it does not know, and the file may have changed since.
    std::uint64_t size() const { return size_; }
    const std::string& name() const { return name_; }

  private:
    std::string name_;
    int descriptor_ = -1;
    std::uint64_t size_ = 0;
};

// Replaces `file` with the bytes, or leaves it as it was and throws Error: the bytes go to a temporary name in the same
// folder, reach the disk, and are renamed. A link is followed, the permissions of an existing file are kept. Only an
// existing regular file is ever replaced.
void write_atomically(const std::filesystem::path& file, std::string_view bytes);

// The same for a library that writes files itself: write(temporary) fills the (existing, empty) temporary file. If it
// throws, the temporary file is removed and the exception goes on. `write` must not keep the file open.
void write_atomically(const std::filesystem::path& file,
                      const std::function<void(const std::filesystem::path& temporary)>& write);

// Throws Error unless write_atomically could write there now: the folder exists and can be written to, and what is
// there already, if anything, is a regular file that can be replaced.
void check_can_write(const std::filesystem::path& file);

// The ending of a file name in lower case, with its dot: ".exr"; empty if there is none.
std::string lower_extension(const std::filesystem::path& file);

// The name without its endings, ".gz" included: "bunny" of "scans/bunny.ply.gz".
std::string inner_stem(const std::filesystem::path& file);

} // namespace snell
