;; SPDX-License-Identifier: Apache-2.0
;; Debugs the system named on the command line with dap-mode, a client of the Debug Adapter Protocol that shares nothing
;; with the adapter or its tests: stops at a breakpoint in a tree, steps forwards and backwards, and evaluates. Prints
;; what it sees.

(setq lsp-session-file (make-temp-file "lsp-session") dap-breakpoints-file (make-temp-file "dap-breakpoints"))
(require 'dap-mode)
(setq dap-auto-show-output nil dap-ui-buffer-configurations nil)
(advice-add 'lsp-workspace-root :override (lambda (&rest _) default-directory))
(advice-add 'yes-or-no-p :override (lambda (&rest _) t))

(defvar has-stopped nil)
(add-hook 'dap-stopped-hook (lambda (_) (setq has-stopped t)))

(defun wait-for (condition)
  "Let Emacs go on until CONDITION returns a value, and return it. The limit only prevents an endless wait."
  (let ((end (+ (float-time) 500)) (value nil))
    (while (and (not (setq value (funcall condition))) (< (float-time) end))
      (accept-process-output nil 0.05))
    value))

(defun request (command arguments)
  "The body of the answer to a request."
  (let ((answer 'none))
    (dap--send-message (dap--make-request command arguments)
                       (lambda (message) (setq answer message))
                       (dap--cur-session))
    (wait-for (lambda () (not (eq answer 'none))))
    (gethash "body" answer)))

(defun move (command)
  "Move the run, wait until it has stopped, and print where."
  (request command (list :threadId 1))
  (wait-for (lambda () (gethash "choices" (request "choices" nil))))
  (where command))

(defun where (after)
  (let* ((frames (gethash "stackFrames" (request "stackTrace" (list :threadId 1))))
         (step (gethash "step" (request "choices" nil))))
    (princ (format "after %s: %s, step %s\n" after (gethash "name" (elt frames 0)) step))))

(let ((file (expand-file-name (pop command-line-args-left))))
  (find-file file)
  (dap-register-debug-provider
   "as2fm" (lambda (conf) (plist-put conf :dap-server-path '("as2fm-lsp" "debug"))))
  (dap-debug (list :type "as2fm" :request "launch" :name "system" :program file))
  (wait-for (lambda () has-stopped))
  (where "launch")
  (request "setFunctionBreakpoints" (list :breakpoints (vector (list :name "PickUp"))))
  (move "continue")
  (move "stepIn")
  (move "stepBack")
  (princ (format "holding: %s\n" (gethash "result" (request "evaluate" (list :expression "Arm.holding")))))
  (request "disconnect" nil))
