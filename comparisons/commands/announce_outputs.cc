#include <string>

#include "comparisons/commands/commands.h"
#include "comparisons/system/files.h"

namespace softfinger::commands {

void announce_outputs(const CLI::App& app) {
  for (const CLI::App* command : app.get_subcommands())
    for (const std::string option :
         {"--output", "--page", "--picture", "--write-scene", "--export-compliance",
          "--taxels-output", "--taxels-picture"}) {
      const CLI::Option* typed = command->get_option_no_throw(option);
      if (!typed) continue;
      for (const std::string& path : typed->results())
        if (!path.empty()) system::announce_output(option, path);
    }
}

}  // namespace softfinger::commands
