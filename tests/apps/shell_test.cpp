// Completion scripts in the shells themselves, manual pages through groff; skipped where a program is not installed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <sstream>

#include "support/command.hpp"
#include "support/temp.hpp"

namespace phasescan::shell_test {
namespace {

using test::run_command;
using test::TempFolder;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

struct ShellResult {
  int code = -1;
  std::string out;
};

ShellResult shell(const std::string& line) {
  ShellResult result;
  FILE* pipe = ::popen(("exec 2>&1; " + line).c_str(), "r");
  std::array<char, 4096> buffer{};
  while (const std::size_t got = std::fread(buffer.data(), 1, buffer.size(), pipe))
    result.out.append(buffer.data(), got);
  result.code = ::pclose(pipe);
  return result;
}

bool installed(const std::string& program) {
  return shell("command -v " + program).code == 0;
}

TEST(Completion, BashOffersCommandsFlagsAndWords) {
  const TempFolder folder;
  const std::string script = folder.put("completion", run_command({"completion", "bash"}).out);
  const auto offered = [&](const std::string& words) {
    const std::string test =
        folder.put("test.sh", ". " + script + "\ncompopt() { echo \"[compopt $*]\"; }\nCOMP_WORDS=(" + words +
                                  ")\nCOMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n_phasescan\necho "
                                  "\"${COMPREPLY[*]}\"\n");
    const ShellResult result = shell("bash " + test);
    EXPECT_EQ(result.code, 0) << result.out;
    return result.out;
  };
  EXPECT_EQ(offered("phasescan sl"), "slam\n");
  EXPECT_THAT(offered("phasescan ''"),
              AllOf(HasSubstr("match slam localize merge info"), Not(HasSubstr("completion"))));
  EXPECT_EQ(offered("phasescan slam --odo"), "--odometry\n");
  EXPECT_EQ(offered("phasescan slam drive.log --odometry ''"), "auto none\n");
  EXPECT_EQ(offered("phasescan match --method fft-icp"), "fft-icp1 fft-icp2\n");
  EXPECT_EQ(offered("phasescan bench retr"), "retrieval\n");
  EXPECT_EQ(offered("phasescan bench retrieval --pla"), "--places\n");
  EXPECT_EQ(offered("phasescan slam --out ''"), "[compopt -o default]\n\n");
  EXPECT_EQ(offered("phasescan slam ''"), "[compopt -o default]\n\n");
  EXPECT_EQ(offered("phasescan slam --range-max ''"), "\n");
}

TEST(Completion, ZshAndFishTakeTheirScripts) {
  const TempFolder folder;
  int seen = 0;
  for (const char* name : {"zsh", "fish"}) {
    const auto script = run_command({"completion", name});
    EXPECT_EQ(script.code, 0);
    EXPECT_THAT(script.out, AllOf(HasSubstr("odometry"), HasSubstr("auto none")));
    if (!installed(name)) continue;
    ++seen;
    const ShellResult parsed = shell(std::string(name) + " -n " + folder.put(name, script.out));
    EXPECT_EQ(parsed.code, 0) << parsed.out;
  }
  if (installed("fish")) {
    EXPECT_EQ(shell("fish -c 'source " + folder / "fish" + "; complete -C \"phasescan sla\"'").out.substr(0, 5),
              "slam\t");
  }
  if (seen == 0) GTEST_SKIP() << "neither zsh nor fish is installed: only what is printed was looked at";
}

TEST(ManPages, GroffHasNothingToSayAgainstThem) {
  if (!installed("groff")) GTEST_SKIP() << "no groff";
  const TempFolder folder;
  for (const char* command :
       {"", "match", "slam", "merge", "info", "convert", "eval", "simulate", "calibrate", "bench", "paper", "config"}) {
    std::vector<std::string> words{"man"};
    if (*command != '\0') words.push_back(command);
    const auto page = run_command(words);
    ASSERT_EQ(page.code, 0) << page.err;
    const std::string file = folder.put("page.1", page.out);
    const ShellResult checked = shell("groff -ww -man -z -Tascii " + file);
    EXPECT_EQ(checked.code, 0);
    EXPECT_EQ(checked.out, "") << command;
  }
  EXPECT_THAT(shell("groff -man -Tascii -P-cbu " + folder.put("eval.1", run_command({"man", "eval"}).out)).out,
              AllOf(HasSubstr("--delta-unit"), HasSubstr("EXIT STATUS"), HasSubstr("phasescan eval --trajectory map")));
  const auto wrong = run_command({"man", "mtach"});
  EXPECT_EQ(wrong.code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("did you mean 'match'?"));
}

TEST(Help, EveryCommandHasAnExample) {
  for (const char* command :
       {"match", "slam", "merge", "info", "convert", "eval", "simulate", "calibrate", "bench", "paper", "config"}) {
    const auto help = run_command({command, "--help"});
    EXPECT_EQ(help.code, 0);
    EXPECT_THAT(help.out, HasSubstr(std::string("Example:\n  phasescan ") + command)) << command;
  }
}

}  // namespace
}  // namespace phasescan::shell_test
