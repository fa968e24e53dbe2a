#include "program.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <thread>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace snell::test {

static std::string content(const std::filesystem::path& file)
{
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

Program::Program()
{
    std::string name = (std::filesystem::temp_directory_path() / "snell_cli_XXXXXX").string();
    if (!mkdtemp(name.data())) throw std::runtime_error("no temporary folder");
    folder_ = std::filesystem::path(name) / "work";
    std::filesystem::create_directory(folder_);
    out_ = std::filesystem::path(name) / "out";
    err_ = std::filesystem::path(name) / "err";
}

Program::~Program()
{
    if (pid_ > 0) {
        kill(pid_, SIGKILL);
        waitpid(pid_, nullptr, 0);
    }
    std::error_code ignored;
    std::filesystem::remove_all(folder_.parent_path(), ignored);
}

void Program::start(const std::vector<std::string>& arguments)
{
    std::vector<std::string> words = {SNELL_PROGRAM};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);

    const int null = open("/dev/null", O_RDONLY);
    const int out = open(out_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    const int err = open(err_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    pid_ = fork();
    if (pid_ == 0) {
        dup2(null, 0);
        dup2(out, 1);
        dup2(err, 2);
        // Seconds of CPU: a program that hangs fails its test.
        const rlim_t seconds = getenv("SNELL_LONG") != nullptr ? 20000 : 100;
        const rlimit limit{seconds, seconds + 10};
        setrlimit(RLIMIT_CPU, &limit);
        if (chdir(folder_.c_str()) == 0) execv(argv[0], argv.data());
        _exit(127);
    }
    close(null);
    close(out);
    close(err);
    if (pid_ < 0) throw std::runtime_error("cannot start " SNELL_PROGRAM);
}

bool Program::wait_for(const std::string& text)
{
    using namespace std::chrono_literals;
    const auto deadline = std::chrono::steady_clock::now() + 60s;
    while (std::chrono::steady_clock::now() < deadline) {
        if (content(err_).find(text) != std::string::npos) return true;
        siginfo_t info{};
        if (waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 && info.si_pid == pid_)
            return false;
        std::this_thread::sleep_for(10ms);
    }
    return false;
}

void Program::send(int signal)
{
    kill(pid_, signal);
}

Outcome Program::wait()
{
    int status = 0;
    if (waitpid(pid_, &status, 0) != pid_) throw std::runtime_error("lost the program");
    pid_ = 0;
    Outcome outcome;
    if (WIFEXITED(status)) outcome.code = WEXITSTATUS(status);
    if (WIFSIGNALED(status)) outcome.signal = WTERMSIG(status);
    outcome.out = content(out_);
    outcome.err = content(err_);
    return outcome;
}

Outcome Program::run(const std::vector<std::string>& arguments)
{
    start(arguments);
    return wait();
}

std::filesystem::path Program::write(const std::string& name, const std::string& text)
{
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
}

std::vector<std::string> Program::files() const
{
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder_))
        names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
}

std::size_t line_count(const std::string& text)
{
    return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

} // namespace snell::test
