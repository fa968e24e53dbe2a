// Runs the snell program as a user would.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <sys/types.h>

namespace snell::test {

struct Outcome
{
    int code = -1;   // exit code; -1 if a signal ended the program
    int signal = 0;  // that ended the program
    std::string out; // stdout
    std::string err; // stderr
};

// A run in a folder of its own, which is removed at the end.
class Program
{
  public:
    Program();
    ~Program();
    Program(const Program&) = delete;
    Program& operator=(const Program&) = delete;

    // Runs it to its end.
    Outcome run(const std::vector<std::string>& arguments);

    // The same in steps: start, look at stderr, send signals, wait.
    void start(const std::vector<std::string>& arguments);
    // False if the program ended, or 60 seconds went by, before stderr contained the text.
    bool wait_for(const std::string& text);
    void send(int signal);
    Outcome wait();

    std::filesystem::path folder() const { return folder_; }
    std::filesystem::path write(const std::string& name, const std::string& text);
    std::vector<std::string> files() const; // in the folder, sorted

  private:
    std::filesystem::path folder_, out_, err_;
    pid_t pid_ = 0;
};

std::size_t line_count(const std::string& text);

} // namespace snell::test
