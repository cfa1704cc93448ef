# extract.awk -- turns a page into a script that follows it: writes each block under <!-- file: NAME --> into that file, and runs
# each block under <!-- run -->, in the order of the page. The script is for bash.
function quoted(text) { gsub(/'/, "'\\''", text); return "'" text "'" }
/^<!-- file: [^ ]+ -->$/ { name = $3; next }
/^<!-- run -->$/ { run = 1; next }
/^```/ && in_block { if (in_block == "file") print end_mark; in_block = ""; name = ""; run = 0; next }
/^```/ {
    if (name != "") {
        in_block = "file"
        end_mark = "END_OF_" ++files "_OF_THE_PAGE"
        print "echo 'writes " name "'"
        print "mkdir -p \"$(dirname " quoted(name) ")\""
        print "cat > " quoted(name) " <<'" end_mark "'"
    } else in_block = run ? "run" : "other"
    next
}
in_block == "file" || in_block == "run" { print }
(name != "" || run) && !in_block && NF { print FILENAME ":" FNR ": no block follows its mark" > "/dev/stderr"; exit 1 }
END { if (in_block != "") { print FILENAME ": the last block does not end" > "/dev/stderr"; exit 1 } }
