# to_script.awk -- turns a page into a script for bash that follows it. Each block below `<!-- file: NAME -->` is written into that file,
# each block below `<!-- run -->` is run, in the order of the page. Of `clarity check`, which takes a minute, only the checks of builds,
# imports, keys and surfaces are run, and two of hits at one lane.
function quoted(text) { gsub(/'/, "'\\''", text); return "'" text "'" }
/^<!-- file: [^ ]+ -->$/ { name = $3; next }
/^<!-- run -->$/ { run = 1; next }
/^```/ && block {
    if (block == "file") print end_mark
    block = ""; name = ""; run = 0
    next
}
/^```/ && name {
    block = "file"
    end_mark = "END_OF_FILE_" ++files "_OF_THE_PAGE"
    print "mkdir -p \"$(dirname " quoted(name) ")\""
    print "cat > " quoted(name) " <<'" end_mark "'"
    next
}
/^```/ { block = run ? "run" : "other"; next }
block == "run" { sub(/^clarity check .*/, "& --only builds --only imports --only keys --only surface --only hits.close --only hits.planes --lanes 1") }
block == "file" || block == "run" { print }
(name || run) && !block && NF { print FILENAME ":" FNR ": no block follows its mark" > "/dev/stderr"; exit failed = 1 }
END {
    if (failed) exit 1
    if (block || !files) { print FILENAME ": the last block does not end, or the page has no files" > "/dev/stderr"; exit 1 }
}
