// A display of a test's own: Xvfb on a free number, for as long as this lives.
#pragma once

#include <string>

#include <sys/types.h>

namespace snell::test {

class Display
{
  public:
    // Sets DISPLAY for this process and those it starts. Throws if there is no Xvfb, or it does not answer in 20
    // seconds.
    Display();
    ~Display();
    Display(const Display&) = delete;
    Display& operator=(const Display&) = delete;

  private:
    pid_t pid_ = 0;
};

// Runs a command of the shell; its exit code.
int shell(const std::string& command);

} // namespace snell::test
