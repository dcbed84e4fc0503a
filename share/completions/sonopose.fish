# Completion for fish, of `sonopose VERB` and of each sonopose-VERB. The programs say what they take.
function __sonopose_words
    set -l words (commandline -opc)
    set -l program $words[1]
    set -l rest $words[2..]
    if test (basename $program) = sonopose
        test (count $words) -ge 2; or return
        set program sonopose-$words[2]
        set rest $words[3..]
    end
    set -l table ($program --print-completions 2>/dev/null)
    set -l command -
    for word in $rest
        if string match -q -- "$word"\t'*' $table
            set command $word
        end
    end
    set -l previous $words[-1]
    for row in $table
        set -l cells (string split \t -- $row)
        if test "$cells[2]" = "$previous"; and test "$cells[3]" != -
            string match -q -- '*|*' $cells[3]; and string split '|' -- $cells[3]
            return
        end
    end
    for row in $table
        set -l cells (string split \t -- $row)
        if test "$cells[1]" = -; or test "$cells[1]" = "$command"
            printf '%s\t%s\n' $cells[2] $cells[4]
        end
    end
end

function __sonopose_verbs
    complete -C sonopose- | string replace -rf '^sonopose-(\S+).*' '$1'
end

complete -c sonopose -n 'test (count (commandline -opc)) -eq 1' -f -a '(__sonopose_verbs)'
for program in sonopose (__sonopose_verbs | string replace -r '^' sonopose-)
    complete -c $program -a '(__sonopose_words)'
end
