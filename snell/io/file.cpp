#include "snell/io/file.h"

#include "snell/core/error.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <new>
#include <utility>

namespace fs = std::filesystem;

namespace snell {

namespace {

std::string reason(int error)
{
    return std::strerror(error);
}

// Closes on every road out.
class Descriptor
{
  public:
    explicit Descriptor(int number) : number_(number) {}
    ~Descriptor()
    {
        if (number_ >= 0) ::close(number_);
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;

    int number() const { return number_; }
    // False if the system reports a write that failed late (full disk on a network file system).
    bool close()
    {
        int n = number_;
        number_ = -1;
        return ::close(n) == 0;
    }

    // Hands it over: it is no longer closed here.
    int release() { return std::exchange(number_, -1); }

  private:
    int number_;
};

// A temporary file beside the target; it is gone when this is, unless it was renamed.
class Temporary
{
  public:
    explicit Temporary(const fs::path& target)
    {
        static std::atomic<unsigned> counter{0};
        fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
        for (int attempt = 0; attempt < 100; ++attempt) {
            // Not made from the target's name: that may already be as long as a name can be.
            fs::path path = folder / fmt::format(".snell-{}-{}.tmp", ::getpid(), counter++);
            int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
            if (descriptor >= 0) {
                ::close(descriptor);
                path_ = path;
                return;
            }
            std::error_code ignored;
            if (errno == ENOENT && fs::is_directory(folder, ignored)) // what /proc answers
                throw Error(
                    {target.string()},
                    fmt::format("the file cannot be created: the folder '{}' takes no new files", folder.string()),
                    "choose another folder");
            if (errno == ENOENT || errno == ENOTDIR)
                throw Error({target.string()}, fmt::format("the folder '{}' does not exist", folder.string()),
                            "create it, or choose another");
            if (errno != EEXIST)
                throw Error({target.string()},
                            fmt::format("cannot write into the folder '{}': {}", folder.string(), reason(errno)),
                            "choose another folder, or change its permissions");
        }
        throw Error({target.string()}, "found no free name for a temporary file",
                    fmt::format("remove the files .snell-*.tmp from '{}'", folder.string()));
    }
    ~Temporary()
    {
        if (!path_.empty()) ::unlink(path_.c_str());
    }
    Temporary(const Temporary&) = delete;
    Temporary& operator=(const Temporary&) = delete;

    const fs::path& path() const { return path_; }

    void rename_to(const fs::path& target)
    {
        if (::rename(path_.c_str(), target.c_str()) != 0)
            throw Error({target.string()}, fmt::format("cannot put the finished file in place: {}", reason(errno)),
                        "choose another name");
        path_.clear();
    }

  private:
    fs::path path_;
};

// The file that is to be replaced: links followed, kinds of files that must not be replaced refused.
fs::path resolve_target(const fs::path& file)
{
    if (!file.has_filename()) throw Error({file.string()}, "is not a file's name", "name a file, such as picture.exr");
    std::error_code error;
    fs::path target = file;
    if (fs::is_symlink(target, error)) {
        fs::path end = fs::weakly_canonical(target, error);
        if (!error) target = end;
    }
    struct stat info = {};
    if (::stat(target.c_str(), &info) != 0) {
        if (errno == ENOENT || errno == ENOTDIR) return target; // new, or no such folder: found out when writing
        throw Error({file.string()}, fmt::format("cannot be a file's name: {}", reason(errno)), "choose another name");
    }
    if (S_ISDIR(info.st_mode)) throw Error({file.string()}, "is a folder", "name a file in it");
    // Renaming over a device would remove the device.
    if (!S_ISREG(info.st_mode)) throw Error({file.string()}, "is a device, pipe or socket", "name a regular file");
    if (::access(target.c_str(), W_OK) != 0)
        throw Error({file.string()}, fmt::format("must not be replaced: {}", reason(errno)),
                    "choose another name, or change its permissions");
    return target;
}

[[noreturn]] void fail_writing(const fs::path& file, int error)
{
    throw Error({file.string()}, fmt::format("writing failed: {}", reason(error)), "check the disk's free space");
}

} // namespace

InputFile::InputFile(const fs::path& file) : name_(file.string())
{
    // O_NONBLOCK: opening a pipe must not wait for somebody to write into it.
    Descriptor in(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (in.number() < 0) {
        if (errno == ENOENT || errno == ENOTDIR) throw Error({name_}, "no such file", "check the path");
        throw Error({name_}, fmt::format("cannot be opened: {}", reason(errno)), "check the path and its permissions");
    }
    struct stat info = {};
    if (::fstat(in.number(), &info) != 0) throw Error({name_}, fmt::format("cannot be examined: {}", reason(errno)));
    if (S_ISDIR(info.st_mode)) throw Error({name_}, "is a folder", "name a file in it");
    if (!S_ISREG(info.st_mode)) throw Error({name_}, "is a device, pipe or socket", "name a regular file");
    size_ = static_cast<std::uint64_t>(info.st_size);
    descriptor_ = in.release();
}

InputFile::~InputFile()
{
    ::close(descriptor_);
}

std::size_t InputFile::read(char* to, std::size_t size)
{
    std::size_t done = 0;
    while (done < size) {
        const ssize_t n = ::read(descriptor_, to + done, size - done);
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) throw Error({name_}, fmt::format("reading failed: {}", reason(errno)));
        if (n == 0) break;
        done += static_cast<std::size_t>(n);
    }
    return done;
}

std::string read_file(const fs::path& file)
{
    InputFile in(file);
    try {
        // The file may have become shorter since, or be one whose size the system does not know: read to its end.
        std::string bytes(static_cast<std::size_t>(in.size()), '\0');
        bytes.resize(in.read(bytes.data(), bytes.size()));
        char extra[4096];
        while (const std::size_t n = in.read(extra, sizeof(extra))) bytes.append(extra, n);
        return bytes;
    } catch (const std::bad_alloc&) {
    } catch (const std::length_error&) {
    }
    throw Error({in.name()}, fmt::format("{} bytes do not fit into memory", in.size()), "use a smaller file");
}

void write_atomically(const fs::path& file, const std::function<void(const fs::path& temporary)>& write)
{
    fs::path target = resolve_target(file);
    Temporary temporary(target);
    write(temporary.path());

    Descriptor out(::open(temporary.path().c_str(), O_WRONLY | O_CLOEXEC));
    if (out.number() < 0) fail_writing(file, errno);
    struct stat previous = {};
    if (::stat(target.c_str(), &previous) == 0) {
        // A file system without permissions may refuse; the picture matters more.
        [[maybe_unused]] int ignored = ::fchmod(out.number(), previous.st_mode & 07777);
    }
    // Without this a power cut soon after could leave the new name with no content.
    if (::fsync(out.number()) != 0 && errno != EINVAL) fail_writing(file, errno);
    if (!out.close()) fail_writing(file, errno);
    temporary.rename_to(target);
}

void write_atomically(const fs::path& file, std::string_view bytes)
{
    write_atomically(file, [&](const fs::path& temporary) {
        Descriptor out(::open(temporary.c_str(), O_WRONLY | O_TRUNC | O_CLOEXEC));
        if (out.number() < 0) fail_writing(file, errno);
        while (!bytes.empty()) {
            ssize_t n = ::write(out.number(), bytes.data(), bytes.size());
            if (n < 0 && errno == EINTR) continue;
            if (n < 0) fail_writing(file, errno);
            bytes.remove_prefix(static_cast<std::size_t>(n));
        }
        if (!out.close()) fail_writing(file, errno);
    });
}

void check_can_write(const fs::path& file)
{
    // Asking for permissions is not enough: a quota or a read-only file system shows only when one tries.
    Temporary probe(resolve_target(file));
}

std::string lower_extension(const fs::path& file)
{
    std::string extension = file.extension().string();
    for (char& c : extension) {
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    }
    return extension;
}

std::string inner_stem(const fs::path& file)
{
    return (lower_extension(file) == ".gz" ? file.stem() : file.filename()).stem().string();
}

} // namespace snell
