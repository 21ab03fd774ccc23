;; SPDX-License-Identifier: Apache-2.0
;; Opens the file named on the command line and prints its diagnostics, and what is completed where the first one stands.

(defun wait-for (condition)
  "Let Emacs go on until CONDITION gives something, and give that."
  (let ((end (+ (float-time) 60)) (found nil))
    (while (and (not (setq found (funcall condition))) (< (float-time) end))
      (accept-process-output nil 0.05))
    found))

(find-file (pop command-line-args-left))
(run-hooks 'post-command-hook) ; this is when eglot connects
(wait-for #'eglot-current-server)
(dolist (diagnostic (wait-for #'flymake-diagnostics))
  ;; eglot says `source [code]: message', or `message [code]' in later versions.
  (let ((text (flymake-diagnostic-text diagnostic)))
    (princ (format "diagnostic: %s\n"
                   (if (string-match "\\[\\([a-z-]+\\)\\]" text) (match-string 1 text) text)))))
(if (not (eglot--server-capable :completionProvider))
    (princ "completion: not offered\n")
  (goto-char (point-min))
  (search-forward "location=\"")
  (let ((table (nth 2 (eglot-completion-at-point))))
    (dolist (name (all-completions "" table))
      (princ (format "completion: %s\n" (string-trim (substring-no-properties name)))))))
