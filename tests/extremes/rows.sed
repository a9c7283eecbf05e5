# Rows "ok | scene | expectation | outcome | error" of the tests of extreme scenes.
s/^(not ok|ok) [0-9]+ - the scene "(.*)" leads to "(.*)" where "(.*)" is expected \(error (.*)\).*/\1 | \2 | \4 | \3 | \5/p
