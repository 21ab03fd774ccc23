---@brief
---
--- Language server for HL-SCXML models of ROS 2 robots and for behavior trees of BehaviorTree.CPP.
---
--- `as2fm-lsp` is installed with pip:
---
--- ```sh
--- pip install as2fm-lsp
--- ```

vim.filetype.add({ extension = { ascxml = "ascxml", scxml = "scxml", jani = "json" } })

---@type vim.lsp.Config
return {
    cmd = { "as2fm-lsp" },
    filetypes = { "ascxml", "scxml", "xml", "json" },
    root_markers = { "as2fm.toml", ".git" },
}
