#include "display.h"

#include <csignal>
#include <cstdlib>
#include <stdexcept>

#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

namespace snell::test {

Display::Display()
{
    int ends[2];
    if (pipe(ends) != 0) throw std::runtime_error("no pipe");
    pid_ = fork();
    if (pid_ == 0) {
        close(ends[0]);
        dup2(ends[1], 3);
        if (ends[1] != 3) close(ends[1]);
        freopen("/dev/null", "w", stderr);
        execlp("Xvfb", "Xvfb", "-displayfd", "3", "-screen", "0", "1400x900x24", "-nolisten", "tcp", nullptr);
        _exit(127);
    }
    close(ends[1]);
    std::string number;
    for (;;) {
        pollfd wait{ends[0], POLLIN, 0};
        char c = 0;
        if (poll(&wait, 1, 20000) <= 0 || read(ends[0], &c, 1) != 1 || c == '\n') break;
        number += c;
    }
    close(ends[0]);
    if (number.empty()) throw std::runtime_error("Xvfb gives no display: install xvfb");
    setenv("DISPLAY", (":" + number).c_str(), 1);
    unsetenv("WAYLAND_DISPLAY");
}

Display::~Display()
{
    kill(pid_, SIGTERM);
    waitpid(pid_, nullptr, 0);
    unsetenv("DISPLAY");
}

int shell(const std::string& command)
{
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

} // namespace snell::test
