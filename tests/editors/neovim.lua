-- SPDX-License-Identifier: Apache-2.0
-- Prints the diagnostics of the open file, and what is completed where the first one stands.

local function say(text)
    io.stdout:write(text .. "\n")
end

vim.wait(60000, function()
    return #vim.diagnostic.get(0) > 0
end, 50)
for _, diagnostic in ipairs(vim.diagnostic.get(0)) do
    say("diagnostic: " .. tostring(diagnostic.code or diagnostic.user_data.lsp.code))
end

local found = vim.diagnostic.get(0)[1]
local client = vim.tbl_values(vim.lsp.buf_get_clients(0))[1]
if not client or not client.server_capabilities.completionProvider then
    say("completion: not offered")
elseif found then
    local params = {
        textDocument = vim.lsp.util.make_text_document_params(0),
        position = { line = found.lnum, character = found.col },
    }
    local answer = vim.lsp.buf_request_sync(0, "textDocument/completion", params, 10000) or {}
    for _, each in pairs(answer) do
        for _, item in ipairs(vim.lsp.util.extract_completion_items(each.result or {})) do
            say("completion: " .. item.label)
        end
    end
end
vim.cmd("qall!")
